"""Registers of the processor, several in one call of Unicorn's library: the binding's own calls look up
the kind of each register anew, which takes longer than an interrupt's instructions."""

import ctypes

from unicorn import UC_ERR_OK, UcError
from unicorn.unicorn_py3.unicorn import uclib


class Registers:
    """Registers by their numbers, each of up to 64 bits."""

    def __init__(self, uc, *numbers):
        self.uc, self.count = uc, len(numbers)
        self.numbers = (ctypes.c_int * self.count)(*numbers)
        self.values = (ctypes.c_uint64 * self.count)()
        first = ctypes.addressof(self.values)
        places = (first + 8 * index for index in range(self.count))
        self.places = (ctypes.c_void_p * self.count)(*places)

    def read(self):
        """Returns their values."""
        status = uclib.uc_reg_read_batch(self.uc._uch, self.numbers, self.places, self.count)
        if status != UC_ERR_OK:
            raise UcError(status)
        return self.values[:]

    def write(self, *values):
        self.values[:] = values
        status = uclib.uc_reg_write_batch(self.uc._uch, self.numbers, self.places, self.count)
        if status != UC_ERR_OK:
            raise UcError(status)
