/* A flight: rounds of the control loop with a stage that follows, a shutter that obeys, and V/H of a
 * sensor, from arming to the record of every trigger. */
#include "fmc_camera.h"
#include "print.h"

/* Rounds of 1 ms, and those in which triggers come. */
#define ROUNDS 8900u
#define FIRST_TRIGGER 3000u
#define TRIGGER_EVERY 1500u

/* Focus shift of one frame more, the round in which it is told, and the last round. */
#define SHIFT_UM 12.5f
#define SHIFTED_AT 8950u
#define LAST_ROUND 10400u

static fmc_camera camera;
static fmc_flight flight;
static fmc_frame frame;
static fmc_record kept;
static fmc_record read;
static uint8_t bytes[FMC_RECORD_CAPACITY];
static fmc_action actions[FMC_MAX_ACTIONS];

/* The world around the camera. */
static float place_mm;
static uint64_t opens_us;
static uint64_t closes_us;
static uint32_t ready;
static uint32_t faults;
static uint32_t action_bits = DIGEST_BEGIN;

static int refused(const fmc_error *error) {
  char text[256];
  (void)fmc_error_text(error, text, sizeof text);
  platform_write(text);
  platform_write("\n");
  return 1;
}

static void obey(const fmc_action *action) {
  action_bits = digest(action_bits, &action->kind, sizeof action->kind);
  action_bits = digest(action_bits, action->values, sizeof action->values);
  switch (action->kind) {
  case FMC_ACTION_OPEN_SHUTTER:
    /* The latency of the settings. */
    opens_us = action->time_us + 2000u;
    closes_us = opens_us + (uint64_t)(1e6f * action->values[0] + 0.5f);
    break;
  case FMC_ACTION_FRAME_READY:
    ready = action->number;
    break;
  case FMC_ACTION_FAULT:
    faults = 256u * faults + action->number;
    break;
  default:
    break;
  }
}

static fmc_status step(uint64_t time_us, fmc_code kind, uint64_t number, float value,
                       fmc_error *error) {
  fmc_event event = {0u, 0u, 0, {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f}};
  size_t count = 0u;
  size_t i;
  fmc_status status;
  event.time_us = time_us;
  event.kind = kind;
  event.number = number;
  event.values[0] = value;
  status = fmc_flight_step(&flight, &event, actions, &count, error);
  if (status != FMC_OK) {
    return status;
  }
  for (i = 0u; i < count; i++) {
    obey(&actions[i]);
  }
  return FMC_OK;
}

/* One round: what came since the last, then the stage, then the tick. */
static fmc_status make_round(uint32_t number, fmc_error *error) {
  uint64_t now_us = 1000u * (uint64_t)number;
  fmc_status status = FMC_OK;
  if (number == 10u) {
    status = step(now_us, FMC_EVENT_ARM, 0u, 0.0f, error);
  }
  if (status == FMC_OK && (number % 500u) == 5u) {
    status = step(now_us, FMC_EVENT_VH, 0u, 0.1f, error);
  }
  if (status == FMC_OK && number == SHIFTED_AT) {
    /* The calibration has no focus table, in which a temperature would have an effect. */
    status = step(now_us, FMC_EVENT_TEMPERATURE, 0u, -12.5f, error);
    if (status == FMC_OK) {
      status = step(now_us, FMC_EVENT_FOCUS_SHIFT, 0u, SHIFT_UM, error);
    }
  }
  if (status == FMC_OK && number >= FIRST_TRIGGER && (number % TRIGGER_EVERY) == 0u) {
    status = step(now_us, FMC_EVENT_TRIGGER, 0u, 0.0f, error);
  }
  if (status == FMC_OK && opens_us != 0u && opens_us <= now_us) {
    status = step(opens_us, FMC_EVENT_SHUTTER_OPENED, 0u, 0.0f, error);
    opens_us = 0u;
  }
  if (status == FMC_OK && closes_us != 0u && closes_us <= now_us) {
    status = step(closes_us, FMC_EVENT_SHUTTER_CLOSED, 0u, 0.0f, error);
    closes_us = 0u;
  }
  if (status == FMC_OK) {
    fmc_action setpoint;
    status = fmc_flight_setpoint(&flight, now_us, &setpoint, error);
    if (status == FMC_OK && setpoint.kind == FMC_ACTION_MOVE_STAGE) {
      place_mm = setpoint.values[0];
    }
  }
  if (status == FMC_OK) {
    status = step(now_us, FMC_EVENT_STAGE, now_us, place_mm, error);
  }
  if (status == FMC_OK) {
    status = step(now_us, FMC_EVENT_TICK, 0u, 0.0f, error);
  }
  return status;
}

static fmc_status begin(fmc_error *error) {
  fmc_camera_record record;
  fmc_flight_settings settings;
  fmc_status status =
      fmc_camera_record_defaults(&record, sizeof record, FMC_CAMERA_VERSION, error);
  if (status != FMC_OK) {
    return status;
  }
  record.principal_distance_mm = 51.3712f;
  record.width_px = 14204u;
  record.height_px = 10652u;
  record.pixel_um = 3.76f;
  record.k1 = -1.6056e-5f;
  record.limits_vh_per_s[1] = 0.2f;
  record.serial[0] = '7';
  status = fmc_camera_init(&camera, &record, error);
  if (status == FMC_OK) {
    status = fmc_flight_settings_defaults(&settings, sizeof settings, FMC_CAMERA_VERSION, error);
  }
  if (status == FMC_OK) {
    status = fmc_flight_init(&flight, &camera, &settings, FMC_START_ORDERLY, error);
  }
  return status;
}

/* Prints the record of a trigger, and its bytes there and back. */
static fmc_status show(uint32_t sequence, fmc_error *error) {
  size_t count = 0u;
  uint32_t crc32 = 0u;
  fmc_status status = fmc_flight_record(&flight, sequence, &kept, error);
  if (status == FMC_OK) {
    status = fmc_record_to_bytes(&kept, bytes, sizeof bytes, &count, &crc32, error);
  }
  if (status == FMC_OK) {
    status = fmc_record_from_bytes(&read, bytes, count, crc32, error);
  }
  if (status == FMC_OK) {
    size_t again = 0u;
    uint32_t sum = 0u;
    status = fmc_record_to_bytes(&read, bytes, sizeof bytes, &again, &sum, error);
    if (again != count || sum != crc32) {
      platform_write("record changed in its bytes\n");
    }
  }
  if (status == FMC_OK) {
    platform_write(kept.outcome == FMC_EXPOSED ? "exposed " : "refused ");
    print_line("record", kept.sequence, crc32);
  }
  return status;
}

/* Flies one frame more, whose focus is shifted; returns 0 if its record says so. */
static int shifted(fmc_error *error) {
  uint32_t number;
  for (number = ROUNDS + 1u; number <= LAST_ROUND; number++) {
    if (make_round(number, error) != FMC_OK) {
      return refused(error);
    }
  }
  if (ready != 5u || fmc_flight_record(&flight, ready, &kept, error) != FMC_OK) {
    platform_write("no record of the shifted frame\n");
    return 1;
  }
  if (kept.outcome != FMC_EXPOSED || 1000.0f * kept.interior.focus_shift_mm < SHIFT_UM - 0.001f ||
      1000.0f * kept.interior.focus_shift_mm > SHIFT_UM + 0.001f) {
    platform_write("focus shift of the record: WRONG\n");
    return 1;
  }
  return 0;
}

int main(void) {
  fmc_error error;
  fmc_flight_status status;
  fmc_point point = {20.0f, -15.0f};
  uint32_t number;
  uint32_t sequence = 0u;

  if (begin(&error) != FMC_OK) {
    return refused(&error);
  }
  for (number = 1u; number <= ROUNDS; number++) {
    if (make_round(number, &error) != FMC_OK) {
      return refused(&error);
    }
    if (ready != 0u) {
      if (show(ready, &error) != FMC_OK) {
        return refused(&error);
      }
      ready = 0u;
    }
  }
  if (fmc_flight_frame(&flight, &sequence, &frame, &error) != FMC_OK ||
      fmc_correct(&camera, &frame, &point, 1u, &error) != FMC_OK ||
      fmc_flight_acknowledge(&flight, sequence - 1u, &error) != FMC_OK ||
      fmc_flight_state(&flight, &status, &error) != FMC_OK) {
    return refused(&error);
  }
  print_line("last frame", sequence, digest(DIGEST_BEGIN, &point, sizeof point));
  print_line("actions of triggers", status.triggers, action_bits);
  print_line("records left", status.records, faults);
  print_line("state", (uint32_t)status.state, (uint32_t)status.fault);
  return status.state == FMC_STATE_ARMED ? shifted(&error) : 1;
}
