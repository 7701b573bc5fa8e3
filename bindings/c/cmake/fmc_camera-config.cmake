# find_package(fmc_camera CONFIG REQUIRED) gives the library fmc_camera::fmc_camera for the processor
# that is compiled for; FMC_CAMERA_TARGET names another one of the directories in lib.
if(NOT DEFINED FMC_CAMERA_TARGET)
  if(NOT CMAKE_SYSTEM_NAME STREQUAL "Generic" AND NOT CMAKE_SYSTEM_NAME STREQUAL "Zephyr")
    set(FMC_CAMERA_TARGET host)
  elseif(CMAKE_C_FLAGS MATCHES "cortex-m(33|35p|55|85)" OR CMAKE_SYSTEM_PROCESSOR MATCHES "cortex-m(33|35p|55|85)")
    set(FMC_CAMERA_TARGET thumbv8m.main-none-eabihf)
  elseif(CMAKE_C_FLAGS MATCHES "float-abi=hard")
    set(FMC_CAMERA_TARGET thumbv7em-none-eabihf)
  else()
    set(FMC_CAMERA_TARGET thumbv7em-none-eabi)
  endif()
endif()

get_filename_component(fmc_camera_root "${CMAKE_CURRENT_LIST_DIR}/.." ABSOLUTE)
set(fmc_camera_archive "${fmc_camera_root}/lib/${FMC_CAMERA_TARGET}/libfmc_camera.a")
if(NOT EXISTS "${fmc_camera_archive}")
  set(fmc_camera_FOUND FALSE)
  set(fmc_camera_NOT_FOUND_MESSAGE "no library for ${FMC_CAMERA_TARGET}: ${fmc_camera_archive}")
  return()
endif()

if(NOT TARGET fmc_camera::fmc_camera)
  add_library(fmc_camera::fmc_camera STATIC IMPORTED)
  set_target_properties(fmc_camera::fmc_camera PROPERTIES
    IMPORTED_LOCATION "${fmc_camera_archive}"
    INTERFACE_INCLUDE_DIRECTORIES "${fmc_camera_root}/include")
  if(FMC_CAMERA_TARGET STREQUAL "host")
    set_target_properties(fmc_camera::fmc_camera PROPERTIES
      INTERFACE_LINK_LIBRARIES "pthread;dl;m")
  else()
    # The link succeeds exactly if no panic can be reached.
    set_target_properties(fmc_camera::fmc_camera PROPERTIES
      INTERFACE_LINK_LIBRARIES "-Wl,--gc-sections")
  endif()
endif()
