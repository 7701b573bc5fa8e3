/* The camera in C: fmc-camera, docs/c.md. Written by cbindgen; bindings/c/tests compares it. */

#ifndef FMC_CAMERA_H
#define FMC_CAMERA_H

#include <stddef.h>
#include <stdint.h>

/**
 * Most bytes of a calibration.
 */
#define FMC_BLOB_CAPACITY 336

/**
 * Words of a camera.
 */
#define FMC_CAMERA_WORDS 66

/**
 * Terms of the polynomial of the stage's run-out.
 */
#define FMC_FLATNESS_TERMS 5

/**
 * Characters of a serial number.
 */
#define FMC_SERIAL_LENGTH 16

/**
 * No quantity.
 */
#define FMC_NO_QUANTITY -1

/**
 * Numbers of an event.
 */
#define FMC_EVENT_VALUES 6

/**
 * Numbers of an action.
 */
#define FMC_ACTION_VALUES 3

/**
 * Words of a flight.
 */
#define FMC_FLIGHT_WORDS 1536

/**
 * Most actions of one event.
 */
#define FMC_MAX_ACTIONS 6

/**
 * Words of a frame.
 */
#define FMC_FRAME_WORDS 24

/**
 * Words of a mesh.
 */
#define FMC_MESH_WORDS 24

/**
 * Most bytes of a record.
 */
#define FMC_RECORD_CAPACITY 256

/**
 * Version of this header, 0xMMmmpp: it changes with every structure.
 */
#define FMC_CAMERA_VERSION 256

/**
 * Status of a call: `FMC_OK`, or the reason for its refusal.
 */
typedef int32_t fmc_status;

/**
 * A validated camera, in storage of the caller; it may be copied.
 */
typedef struct fmc_camera {
  /**
   * Words of the library alone.
   */
  uint64_t opaque[FMC_CAMERA_WORDS];
} fmc_camera;

/**
 * A choice between named values; what each means stands at its code.
 */
typedef int32_t fmc_code;

/**
 * The reason for a refusal. Fields that a status does not use are 0, and `quantity` is
 * `FMC_NO_QUANTITY`.
 */
typedef struct fmc_error {
  /**
   * Status of the call.
   */
  fmc_status status;
  /**
   * Quantity that was refused: its name is that of the camera file (`fmc_quantity_name`).
   */
  int32_t quantity;
  /**
   * Its value, in the unit of its name.
   */
  float value;
  /**
   * Smallest allowed value.
   */
  float least;
  /**
   * Largest allowed value.
   */
  float most;
  /**
   * Second value, where there are two.
   */
  float other;
  /**
   * Place on the sensor, mm.
   */
  float x_mm;
  /**
   * Place on the sensor, mm.
   */
  float y_mm;
  /**
   * Index of the point or the byte, from 0.
   */
  uint32_t index;
  /**
   * Argument of the call, from 1; 0 if the refusal is about none.
   */
  uint32_t argument;
  /**
   * Number that was found.
   */
  uint32_t number;
  /**
   * Number that was expected.
   */
  uint32_t expected;
} fmc_error;

/**
 * A camera, as `fmc_camera_record_defaults` begins it. Coefficients are measured - ideal; the keys
 * of a camera file have the same names.
 */
typedef struct fmc_camera_record {
  /**
   * Size of this structure, bytes.
   */
  uint32_t size;
  /**
   * `FMC_CAMERA_VERSION` of the header.
   */
  uint32_t version;
  /**
   * Principal distance, mm.
   */
  float principal_distance_mm;
  /**
   * Distance from exit pupil to image, mm; 0: the principal distance.
   */
  float exit_pupil_mm;
  /**
   * Calibrated principal point, sensor frame, mm.
   */
  float principal_point_x_mm;
  /**
   * Calibrated principal point, sensor frame, mm.
   */
  float principal_point_y_mm;
  /**
   * Columns.
   */
  uint32_t width_px;
  /**
   * Rows.
   */
  uint32_t height_px;
  /**
   * Side of a pixel, µm.
   */
  float pixel_um;
  /**
   * K0.
   */
  float k0;
  /**
   * K1, mm^-2.
   */
  float k1;
  /**
   * K2, mm^-4.
   */
  float k2;
  /**
   * K3, mm^-6.
   */
  float k3;
  /**
   * P1, mm^-1, which goes with x².
   */
  float p1;
  /**
   * P2, mm^-1.
   */
  float p2;
  /**
   * B1.
   */
  float b1;
  /**
   * B2.
   */
  float b2;
  /**
   * `FMC_YES` with a five-coefficient model.
   */
  fmc_code has_fitted;
  /**
   * `K_m0`.
   */
  float km0;
  /**
   * `K_m1`, mm^-2.
   */
  float km1;
  /**
   * `K_m2`, mm^-4.
   */
  float km2;
  /**
   * `K_d1`, mm^-2.
   */
  float kd1;
  /**
   * `P_m1`, mm^-2.
   */
  float pm1;
  /**
   * `FMC_REGRESSOR_...`
   */
  fmc_code regressor;
  /**
   * `FMC_AXIS_...`
   */
  fmc_code axis;
  /**
   * Travel of the stage, plus and minus half of it, mm.
   */
  float stroke_mm;
  /**
   * Run-out of the stage, µm per power of mm, lowest first.
   */
  float flatness_um[FMC_FLATNESS_TERMS];
  /**
   * `FMC_MECHANISM_...`
   */
  fmc_code mechanism;
  /**
   * Acceleration of the stage, mm/s².
   */
  float acceleration_mm_s2;
  /**
   * Settling time between run-up and exposure, ms.
   */
  float settling_ms;
  /**
   * Largest jerk, mm/s³; 0: without limit.
   */
  float jerk_mm_s3;
  /**
   * Largest speed, mm/s; 0: without limit.
   */
  float max_speed_mm_s;
  /**
   * First transfer of a TDI sensor after opening, row periods.
   */
  float first_transfer;
  /**
   * `FMC_SHUTTER_...`
   */
  fmc_code shutter;
  /**
   * Opening ramp of a trapezoid, as a fraction of the base.
   */
  float opening_fraction;
  /**
   * Closing ramp of a trapezoid, as a fraction of the base.
   */
  float closing_fraction;
  /**
   * Smallest and largest V/H, 1/s.
   */
  float limits_vh_per_s[2];
  /**
   * Shortest and longest exposure, s.
   */
  float limits_exposure_s[2];
  /**
   * Serial number, printable ASCII, filled with zeros.
   */
  char serial[FMC_SERIAL_LENGTH];
  /**
   * Version of the calibration; 0: none is given.
   */
  uint32_t calibration_version;
  /**
   * `FMC_VOLATILE` or `FMC_STORED`.
   */
  fmc_code storage;
} fmc_camera_record;

/**
 * Identity of a calibration.
 */
typedef struct fmc_calibration_id {
  /**
   * Serial number, filled with zeros; without a zero at the end if it fills the field.
   */
  char serial[FMC_SERIAL_LENGTH];
  /**
   * Version of the calibration; 0: none is given.
   */
  uint32_t calibration_version;
  /**
   * CRC-32 of all numbers, serial number and version.
   */
  uint32_t crc32;
  /**
   * `FMC_VOLATILE` or `FMC_STORED`.
   */
  fmc_code storage;
} fmc_calibration_id;

/**
 * An exposure, as `fmc_exposure_defaults` begins it.
 */
typedef struct fmc_exposure {
  /**
   * Size of this structure, bytes.
   */
  uint32_t size;
  /**
   * `FMC_CAMERA_VERSION` of the header.
   */
  uint32_t version;
  /**
   * V/H, 1/s, positive in either direction.
   */
  float vh_per_s;
  /**
   * Exposure time, s.
   */
  float exposure_s;
  /**
   * `FMC_YES`: the principal point is at `opening_offset_mm` when the shutter opens; `FMC_NO`: where
   * the mechanism's strategy has it.
   */
  fmc_code has_opening_offset;
  /**
   * Offset along the FMC axis when the shutter opens, mm.
   */
  float opening_offset_mm;
  /**
   * Shift of the detector away from the lens, beyond the stage's run-out, µm.
   */
  float focus_shift_um;
  /**
   * `FMC_FOCUS_...`
   */
  fmc_code focus_sign;
  /**
   * `FMC_MODEL_...`
   */
  fmc_code model;
  /**
   * `FMC_FORWARD` or `FMC_REVERSE`.
   */
  fmc_code direction;
} fmc_exposure;

/**
 * A flight: a camera with the state machine that flies it, in storage of the caller.
 */
typedef struct fmc_flight {
  /**
   * Words of the library alone.
   */
  uint64_t opaque[FMC_FLIGHT_WORDS];
} fmc_flight;

/**
 * Settings of one source of V/H; the unit is that of its sample.
 */
typedef struct fmc_vh_source_settings {
  /**
   * Smallest and largest believable value.
   */
  float range[2];
  /**
   * Longest time between two samples of a healthy source, s.
   */
  float period_s;
  /**
   * Age up to which a sample is used, s.
   */
  float validity_s;
  /**
   * Largest believable rate of change, per s.
   */
  float slew_per_s;
  /**
   * σ of a sample.
   */
  float sigma;
  /**
   * Age of a sample when it arrives, s.
   */
  float latency_s;
  /**
   * Change of the quantity in a second, as a random walk.
   */
  float change_per_sqrt_s;
  /**
   * Time after which an unchanged value is frozen, s; 0: never.
   */
  float frozen_s;
} fmc_vh_source_settings;

/**
 * Settings of motor, encoder and velocity loop.
 */
typedef struct fmc_drive_settings {
  /**
   * Step of the encoder, µm.
   */
  float encoder_step_um;
  /**
   * `FMC_YES` if the encoder counts against the FMC axis.
   */
  fmc_code encoder_reversed;
  /**
   * `FMC_ENCODER_...`
   */
  fmc_code encoder_side;
  /**
   * Play between screw and stage, µm.
   */
  float play_um;
  /**
   * Error of the encoder's scale, ppm.
   */
  float encoder_scale_ppm;
  /**
   * σ of the calibrated position in the encoder's count, µm.
   */
  float zero_sigma_um;
  /**
   * σ of the age of a reading, s.
   */
  float reading_age_sigma_s;
  /**
   * `FMC_YES` if the motor turns against the FMC axis.
   */
  fmc_code motor_reversed;
  /**
   * Gain of the velocity loop from position to speed, 1/s.
   */
  float position_gain_per_s;
  /**
   * Gain from speed to duty, per mm/s.
   */
  float speed_gain_per_mm_s;
  /**
   * Rate of the integral, 1/s.
   */
  float integral_rate_per_s;
  /**
   * Weight of a new slope.
   */
  float slope_weight;
  /**
   * Feed-forward of the speed, per mm/s.
   */
  float speed_feed_per_mm_s;
  /**
   * Feed-forward of the acceleration, per mm/s².
   */
  float acceleration_feed_per_mm_s2;
  /**
   * Feed-forward of the friction.
   */
  float friction_feed;
  /**
   * Largest duty.
   */
  float max_duty;
  /**
   * Band in which the stage rests, µm.
   */
  float rest_band_um;
  /**
   * Rate of learning, 1/s.
   */
  float learning_rate_per_s;
  /**
   * Age of a reading when the loop runs, s.
   */
  float reading_age_s;
  /**
   * Time until a duty acts, s.
   */
  float duty_delay_s;
  /**
   * `FMC_YES` with an index mark.
   */
  fmc_code has_index;
  /**
   * Place of the index mark, mm along the FMC axis.
   */
  float index_mm;
  /**
   * σ of a crossing, µm.
   */
  float index_sigma_um;
  /**
   * `FMC_DRIVE_...`
   */
  fmc_code kind;
  /**
   * σ of one reading of an absolute sensor, µm.
   */
  float sensor_noise_um;
  /**
   * σ by which a stage is off the steps of its stepper, µm.
   */
  float following_sigma_um;
} fmc_drive_settings;

/**
 * Settings of a flight, as `fmc_flight_settings_defaults` begins them. Their ranges stand in
 * `docs/integration.md`.
 */
typedef struct fmc_flight_settings {
  /**
   * Size of this structure, bytes.
   */
  uint32_t size;
  /**
   * `FMC_CAMERA_VERSION` of the header.
   */
  uint32_t version;
  /**
   * Exposure time of the frames to come, s.
   */
  float exposure_s;
  /**
   * `FMC_FORWARD` or `FMC_REVERSE`.
   */
  fmc_code direction;
  /**
   * Largest smear of a frame that is not flagged, pixels.
   */
  float smear_budget_px;
  /**
   * Largest error of the stage's speed at which the shutter is told to open, per cent.
   */
  float speed_tolerance_percent;
  /**
   * Largest following error that is not a fault, µm.
   */
  float following_tolerance_um;
  /**
   * Largest step of a reading beyond its set point's, µm.
   */
  float jump_tolerance_um;
  /**
   * Time from command to first light, s.
   */
  float shutter_latency_s;
  /**
   * Largest error of first light and of exposure in time, s.
   */
  float shutter_tolerance_s;
  /**
   * Shortest planned time between triggers, s; 0 if not known.
   */
  float trigger_interval_s;
  /**
   * σ of the satellite receiver's time pulse, s.
   */
  float time_pulse_sigma_s;
  /**
   * `FMC_YES` if the encoder counts on while the supply is too low for the motor.
   */
  fmc_code encoder_survives_brown_out;
  /**
   * σ of pitch, roll and drift while no attitude is reported, degrees.
   */
  float attitude_sigma_deg;
  /**
   * σ of each attitude rate while no attitude is reported, degrees/s.
   */
  float rate_sigma_deg_s;
  /**
   * Source of V/H.
   */
  struct fmc_vh_source_settings direct;
  /**
   * Source of the ground speed.
   */
  struct fmc_vh_source_settings ground_speed;
  /**
   * Source of the inertial speed.
   */
  struct fmc_vh_source_settings inertial_speed;
  /**
   * Source of the height above ground.
   */
  struct fmc_vh_source_settings height_above_ground;
  /**
   * Source of the laser's height.
   */
  struct fmc_vh_source_settings laser_height;
  /**
   * Source of the altitude.
   */
  struct fmc_vh_source_settings altitude;
  /**
   * Source of the terrain's height.
   */
  struct fmc_vh_source_settings terrain_height;
  /**
   * Difference of V/H of two sources that is a disagreement, per cent.
   */
  float disagreement_percent;
  /**
   * Motor, encoder and velocity loop.
   */
  struct fmc_drive_settings drive;
  /**
   * `FMC_YES` if the frames are corrected by the fitted model of the calibration.
   */
  fmc_code fitted_model;
} fmc_flight_settings;

/**
 * An event. What `number` and `values` hold stands at the code of its kind; the others are not
 * read.
 */
typedef struct fmc_event {
  /**
   * Time of the event, µs since the camera started.
   */
  uint64_t time_us;
  /**
   * Number of the kind.
   */
  uint64_t number;
  /**
   * `FMC_EVENT_...`
   */
  fmc_code kind;
  /**
   * Values of the kind.
   */
  float values[FMC_EVENT_VALUES];
} fmc_event;

/**
 * An action. What the fields hold stands at the code of its kind; the others are 0.
 */
typedef struct fmc_action {
  /**
   * Time at which the action is due, µs since the camera started.
   */
  uint64_t time_us;
  /**
   * `FMC_ACTION_...`
   */
  fmc_code kind;
  /**
   * Number of the kind.
   */
  uint32_t number;
  /**
   * Triggers of `FMC_ACTION_IN_DOUBT`.
   */
  uint32_t count;
  /**
   * Values of the kind.
   */
  float values[FMC_ACTION_VALUES];
} fmc_action;

/**
 * State of a flight.
 */
typedef struct fmc_flight_status {
  /**
   * `FMC_STATE_...`
   */
  fmc_code state;
  /**
   * Code of the fault of `FMC_STATE_DEGRADED` and `FMC_STATE_FAULT`, or 0.
   */
  fmc_code fault;
  /**
   * Triggers since the flight began.
   */
  uint32_t triggers;
  /**
   * Records that have not been acknowledged.
   */
  uint32_t records;
  /**
   * `FMC_START_...` of the flight that may follow: faults that have not been cleared are kept.
   */
  fmc_code next_start;
} fmc_flight_status;

/**
 * Interior orientation of a frame. Offsets are along the FMC axis, from the calibrated position.
 */
typedef struct fmc_interior {
  /**
   * V/H used, 1/s.
   */
  float vh_per_s;
  /**
   * Exposure time, s.
   */
  float exposure_s;
  /**
   * Offset of the principal point when the shutter opens, mm.
   */
  float opening_offset_mm;
  /**
   * Travel of the principal point while the shutter is open, mm.
   */
  float travel_mm;
  /**
   * Time of the centroid after opening, s.
   */
  float centroid_time_s;
  /**
   * Offset of the principal point at the centroid, mm.
   */
  float centroid_mm;
  /**
   * Second central moment of the offset, mm².
   */
  float second_moment_mm2;
  /**
   * Third central moment of the offset, mm³.
   */
  float third_moment_mm3;
  /**
   * Fourth central moment of the offset, mm^4.
   */
  float fourth_moment_mm4;
  /**
   * Principal point at the centroid, sensor frame, mm.
   */
  float principal_point_x_mm;
  /**
   * Principal point at the centroid, sensor frame, mm.
   */
  float principal_point_y_mm;
  /**
   * Principal distance that goes with corrected coordinates, mm.
   */
  float principal_distance_mm;
  /**
   * Run-out and focus shift, mm.
   */
  float focus_shift_mm;
  /**
   * Relative enlargement of the image by the focus shift.
   */
  float enlargement;
  /**
   * `FMC_MODEL_...`
   */
  fmc_code model;
  /**
   * `FMC_YES` if all terms are evaluated, `FMC_NO` if those below 0.5 nm in all are left out.
   */
  fmc_code has_all_terms;
  /**
   * Bound of what model and evaluation leave out, nm per axis.
   */
  float left_out_nm;
} fmc_interior;

/**
 * The record of one trigger. Times are those of the camera, µs since it started.
 */
typedef struct fmc_record {
  /**
   * Time of the trigger, µs.
   */
  uint64_t trigger_us;
  /**
   * First light, µs.
   */
  uint64_t opened_us;
  /**
   * Last light, µs.
   */
  uint64_t closed_us;
  /**
   * Centroid of the exposure, µs.
   */
  uint64_t centroid_us;
  /**
   * The centroid in UTC, µs since 1970.
   */
  uint64_t centroid_unix_us;
  /**
   * Number of the trigger, from 1, without gaps.
   */
  uint32_t sequence;
  /**
   * `FMC_EXPOSED`, or the reason for the refusal, `FMC_REFUSED_...`; all fields of an exposure are 0
   * then.
   */
  fmc_code outcome;
  /**
   * Code of the fault of `FMC_REFUSED_FAULT`, or 0.
   */
  fmc_code refused_by;
  /**
   * Faults, 1 << the place of its code among all.
   */
  uint32_t faults;
  /**
   * Flags, 1 << the place of its name among the flags of `docs/integration.md`, section 7.
   */
  uint64_t flags;
  /**
   * `FMC_YES` with a calibration that has an identity.
   */
  fmc_code has_calibration;
  /**
   * The calibration in use.
   */
  struct fmc_calibration_id calibration;
  /**
   * `FMC_YES` if the satellite receiver has set the clock.
   */
  fmc_code has_utc;
  /**
   * σ of the time in UTC, s.
   */
  float utc_sigma_s;
  /**
   * `FMC_YES` with V/H.
   */
  fmc_code has_vh;
  /**
   * V/H, 1/s.
   */
  float vh_per_s;
  /**
   * σ of V/H, 1/s.
   */
  float vh_sigma_per_s;
  /**
   * Age of V/H, s.
   */
  float vh_age_s;
  /**
   * `FMC_VH_...`
   */
  fmc_code vh_source;
  /**
   * `FMC_YES` if V/H is extrapolated.
   */
  fmc_code vh_extrapolated;
  /**
   * Offset of the plan when the shutter opens, mm.
   */
  float planned_opening_mm;
  /**
   * Travel of the plan, mm.
   */
  float planned_travel_mm;
  /**
   * Interior orientation from the measured motion.
   */
  struct fmc_interior interior;
  /**
   * σ of the centroid principal point that each frame has for itself, mm.
   */
  float sigma_frame_mm;
  /**
   * σ of the centroid principal point that all frames share, mm.
   */
  float sigma_common_mm;
  /**
   * Predicted residual smear, µm.
   */
  float smear_um;
  /**
   * Predicted residual smear, pixels.
   */
  float smear_px;
  /**
   * Number of the camera's start in which the trigger came, from 1.
   */
  uint32_t boot;
  /**
   * Number of the flight, from 1.
   */
  uint32_t flight;
} fmc_record;

/**
 * A frame, in storage of the caller; it may be copied.
 */
typedef struct fmc_frame {
  /**
   * Words of the library alone.
   */
  uint64_t opaque[FMC_FRAME_WORDS];
} fmc_frame;

/**
 * A point of the sensor: x right, y up from the centre of the pixel array, mm.
 */
typedef struct fmc_point {
  /**
   * x, mm.
   */
  float x_mm;
  /**
   * y, mm.
   */
  float y_mm;
} fmc_point;

/**
 * Rows of a frame's mesh, in storage of the caller; it may be copied.
 */
typedef struct fmc_mesh {
  /**
   * Words of the library alone.
   */
  uint64_t opaque[FMC_MESH_WORDS];
} fmc_mesh;

/**
 * Distortion at a point, measured - ideal, mm.
 */
typedef struct fmc_displacement {
  /**
   * Along x, mm.
   */
  float dx_mm;
  /**
   * Along y, mm.
   */
  float dy_mm;
} fmc_displacement;

/**
 * Opening and closing at once.
 */
#define FMC_SHUTTER_UNIFORM 0

/**
 * Linear ramps, as leaf shutters have.
 */
#define FMC_SHUTTER_TRAPEZOID 1

/**
 * No, or without.
 */
#define FMC_NO 0

/**
 * Yes, or with.
 */
#define FMC_YES 1

/**
 * FMC axis along +x of the sensor.
 */
#define FMC_AXIS_PLUS_X 0

/**
 * FMC axis along -x of the sensor.
 */
#define FMC_AXIS_MINUS_X 1

/**
 * FMC axis along +y of the sensor.
 */
#define FMC_AXIS_PLUS_Y 2

/**
 * FMC axis along -y of the sensor.
 */
#define FMC_AXIS_MINUS_Y 3

/**
 * A stage moves the detector; the centroid of the exposure is at the calibrated position.
 */
#define FMC_MECHANISM_STAGE_CENTRED 0

/**
 * A stage moves the detector, from the calibrated position on.
 */
#define FMC_MECHANISM_STAGE_FROM_REST 1

/**
 * The charge moves in rows.
 */
#define FMC_MECHANISM_TDI 2

/**
 * Exposure mean of the calibration about the moving principal point.
 */
#define FMC_MODEL_EXACT 0

/**
 * Five fitted coefficients.
 */
#define FMC_MODEL_FITTED 1

/**
 * Static calibration, motion and focus shift ignored.
 */
#define FMC_MODEL_STATIC 2

/**
 * Flight along the FMC axis.
 */
#define FMC_FORWARD 0

/**
 * Flight against the FMC axis.
 */
#define FMC_REVERSE 1

/**
 * A detector moved away from the lens enlarges the image.
 */
#define FMC_FOCUS_PHYSICAL 0

/**
 * Sign of the focus shift as printed in Yuan et al. 2012, eqs. 14-17.
 */
#define FMC_FOCUS_PRINTED 1

/**
 * kd1 and pm1 go with the travel.
 */
#define FMC_REGRESSOR_TRAVEL 0

/**
 * kd1 and pm1 go with the centroid.
 */
#define FMC_REGRESSOR_CENTROID 1

/**
 * The calibration is in memory alone.
 */
#define FMC_VOLATILE 0

/**
 * The calibration is in the board's own store.
 */
#define FMC_STORED 1

/**
 * The call has done its work.
 */
#define FMC_OK 0

/**
 * A pointer is NULL.
 */
#define FMC_ERROR_NULL 1

/**
 * A pointer is not aligned for what it points to.
 */
#define FMC_ERROR_MISALIGNED 2

/**
 * Two arguments share memory of which one is written.
 */
#define FMC_ERROR_OVERLAP 3

/**
 * There are more elements than memory can hold.
 */
#define FMC_ERROR_TOO_MANY 4

/**
 * A structure does not have the size that the library's has; `number` and `expected` hold both.
 */
#define FMC_ERROR_STRUCT_SIZE 5

/**
 * The header is of another version than the library; `number` and `expected` hold both.
 */
#define FMC_ERROR_VERSION 6

/**
 * The storage does not hold such an object: it was never initialised, or is of another type.
 */
#define FMC_ERROR_UNINITIALISED 7

/**
 * The frame or the mesh is of another calibration than the camera has now.
 */
#define FMC_ERROR_CAMERA_CHANGED 8

/**
 * A code is none of those that its type has; `number` holds it.
 */
#define FMC_ERROR_CODE 9

/**
 * The buffer is too small; `number` holds its size, `expected` the least one.
 */
#define FMC_ERROR_BUFFER 10

/**
 * A quantity is not a number or outside its range.
 */
#define FMC_ERROR_OUT_OF_RANGE 11

/**
 * The distortion polynomial folds the image; `value` holds its scale, at (`x_mm`, `y_mm`).
 */
#define FMC_ERROR_FOLDS 12

/**
 * The five-coefficient model folds the image; `value` holds its scale, at (`x_mm`, `y_mm`).
 */
#define FMC_ERROR_FITTED_FOLDS 13

/**
 * The travel from `value` to `other` leaves the stroke of `most` either side, mm.
 */
#define FMC_ERROR_STROKE 14

/**
 * The speed `value` exceeds the stage's, mm/s.
 */
#define FMC_ERROR_SPEED 15

/**
 * The travel takes `value`, and there are `most`, s.
 */
#define FMC_ERROR_TIME 16

/**
 * The camera has no five-coefficient model.
 */
#define FMC_ERROR_NOT_FITTED 17

/**
 * The measured point of the ideal one, at (`x_mm`, `y_mm`), is off the sensor.
 */
#define FMC_ERROR_OFF_SENSOR 18

/**
 * No measured point was found; `value` holds what is left, nm.
 */
#define FMC_ERROR_NOT_CONVERGED 19

/**
 * The bytes are not what they should be.
 */
#define FMC_ERROR_BYTES 20

/**
 * The bytes have another CRC-32 than stated; `number` and `expected` hold both.
 */
#define FMC_ERROR_CRC 21

/**
 * The calibration has residual grids, which this library does not evaluate.
 */
#define FMC_ERROR_GRIDS 22

/**
 * The serial number has a character that is not printable ASCII, at `index`.
 */
#define FMC_ERROR_SERIAL 23

/**
 * There is no such record or frame.
 */
#define FMC_ERROR_NONE 24

/**
 * Obey triggers.
 */
#define FMC_EVENT_ARM 0

/**
 * Refuse triggers, and release the stage.
 */
#define FMC_EVENT_DISARM 1

/**
 * Acknowledge a fault: the camera goes to standby.
 */
#define FMC_EVENT_CLEAR_FAULT 2

/**
 * The encoder's count has been referred to the calibrated position again.
 */
#define FMC_EVENT_REFERENCED 3

/**
 * Exposure time of the frames to come: `values[0]`, s.
 */
#define FMC_EVENT_EXPOSURE 4

/**
 * V/H of a sensor: `values[0]`, 1/s.
 */
#define FMC_EVENT_VH 5

/**
 * Ground speed of the satellite receiver: `values[0]`, m/s.
 */
#define FMC_EVENT_GROUND_SPEED 6

/**
 * Height above ground of a radar altimeter: `values[0]`, m.
 */
#define FMC_EVENT_HEIGHT_ABOVE_GROUND 7

/**
 * Altitude: `values[0]`, m.
 */
#define FMC_EVENT_ALTITUDE 8

/**
 * Height of the terrain: `values[0]`, m.
 */
#define FMC_EVENT_TERRAIN_HEIGHT 9

/**
 * Ground speed of an inertial unit: `values[0]`, m/s.
 */
#define FMC_EVENT_INERTIAL_SPEED 10

/**
 * Height of a laser altimeter: `values[0]`, m.
 */
#define FMC_EVENT_LASER_HEIGHT 11

/**
 * Pitch, roll, drift, degrees, and rates about right, forward and up, degrees/s: `values[0..6]`.
 */
#define FMC_EVENT_ATTITUDE 12

/**
 * The satellite receiver's pulse: a second begins.
 */
#define FMC_EVENT_TIME_PULSE 13

/**
 * UTC of the last pulse: number, µs since 1970.
 */
#define FMC_EVENT_GNSS_TIME 14

/**
 * A request for an exposure.
 */
#define FMC_EVENT_TRIGGER 15

/**
 * First light.
 */
#define FMC_EVENT_SHUTTER_OPENED 16

/**
 * Last light.
 */
#define FMC_EVENT_SHUTTER_CLOSED 17

/**
 * Offset of the stage along the FMC axis: `values[0]`, mm, read at the time in number, µs.
 */
#define FMC_EVENT_STAGE 18

/**
 * A limit switch has closed.
 */
#define FMC_EVENT_LIMIT_SWITCH 19

/**
 * The drive cannot carry out its command: number is the code of its fault.
 */
#define FMC_EVENT_DRIVE 20

/**
 * The supply voltage is too low to move the stage.
 */
#define FMC_EVENT_SUPPLY_LOW 21

/**
 * The supply voltage is good.
 */
#define FMC_EVENT_SUPPLY_GOOD 22

/**
 * A round of the control loop.
 */
#define FMC_EVENT_TICK 23

/**
 * Events that could not be kept until the round: number of them.
 */
#define FMC_EVENT_LOST 24

/**
 * The index mark was crossed at the reading `values[0]`, mm along the FMC axis.
 */
#define FMC_EVENT_INDEX_MARK 25

/**
 * Offset of the stage that hardware latched between two readings, at an edge of the shutter's sensor
 * (after the edge's event) or in an exposure: `values[0]`, mm along the FMC axis, at the time in
 * number, µs.
 */
#define FMC_EVENT_LATCHED 26

/**
 * Focus shift of the frames to come beyond the run-out of the stage: `values[0]`, µm, positive away
 * from the lens. That of the calibration's focus table is added to it.
 */
#define FMC_EVENT_FOCUS_SHIFT 27

/**
 * Temperature of the lens for the calibration's focus table: `values[0]`, °C, -100 to 100. What is
 * no such number is not taken, and the last temperature stays.
 */
#define FMC_EVENT_TEMPERATURE 28

/**
 * The stage is to follow the set point `values[0]` mm, `values[1]` mm/s, `values[2]` mm/s², now.
 */
#define FMC_ACTION_MOVE_STAGE 0

/**
 * The stage is to be without force.
 */
#define FMC_ACTION_RELEASE_STAGE 1

/**
 * The shutter's command is to leave at `time_us`, for an exposure of `values[0]` s.
 */
#define FMC_ACTION_OPEN_SHUTTER 2

/**
 * The rows of a TDI sensor are to be clocked, from first light of the command at `time_us` on, with
 * `values[0]` mm/s.
 */
#define FMC_ACTION_CLOCK_ROWS 3

/**
 * The shutter is to close at once, or stay closed.
 */
#define FMC_ACTION_CLOSE_SHUTTER 4

/**
 * The record with this number is available.
 */
#define FMC_ACTION_FRAME_READY 5

/**
 * A fault has occurred: number is its code.
 */
#define FMC_ACTION_FAULT 6

/**
 * Principal points from record number on are in doubt by `values[0]` mm, for count triggers.
 */
#define FMC_ACTION_IN_DOUBT 7

/**
 * The camera was switched on, or asked to start again.
 */
#define FMC_START_ORDERLY 0

/**
 * The watchdog was not fed, or the processor failed.
 */
#define FMC_START_AFTER_WATCHDOG 1

/**
 * As `FMC_START_ORDERLY`, but the encoder has lost its place.
 */
#define FMC_START_UNREFERENCED 2

/**
 * A reset has ended the flight, and it goes on: as `FMC_START_AFTER_WATCHDOG`, but the fault ends by itself
 * once the stage stands, and triggers are obeyed without force on the stage.
 */
#define FMC_START_FLIES_ON 3

/**
 * Triggers are refused; the stage is left alone.
 */
#define FMC_STATE_STANDBY 0

/**
 * The stage waits at its starting place; a trigger will be obeyed.
 */
#define FMC_STATE_ARMED 1

/**
 * Armed without compensation because of a fault.
 */
#define FMC_STATE_DEGRADED 2

/**
 * The stage accelerates and settles.
 */
#define FMC_STATE_RUN_UP 3

/**
 * The stage is at speed, the shutter is about to open.
 */
#define FMC_STATE_TRACKING 4

/**
 * The shutter is open.
 */
#define FMC_STATE_EXPOSING 5

/**
 * The stage stops and returns.
 */
#define FMC_STATE_FLY_BACK 6

/**
 * A fault has occurred; the stage is released.
 */
#define FMC_STATE_FAULT 7

/**
 * The encoder is on the screw: it does not see the play.
 */
#define FMC_ENCODER_ON_SCREW 0

/**
 * The encoder is on the stage.
 */
#define FMC_ENCODER_ON_STAGE 1

/**
 * A motor with an encoder that counts.
 */
#define FMC_DRIVE_MOTOR 0

/**
 * A sensor shows the place of the stage at any time, as an LVDT does: no place is lost, and play,
 * index mark and friction do not count.
 */
#define FMC_DRIVE_ABSOLUTE 1

/**
 * A stepper, which nothing measures.
 */
#define FMC_DRIVE_STEPPER 2

/**
 * The shutter opened.
 */
#define FMC_EXPOSED 0

/**
 * The camera was not armed.
 */
#define FMC_REFUSED_NOT_ARMED 1

/**
 * The previous frame was not finished.
 */
#define FMC_REFUSED_OVERLAP 2

/**
 * V/H or exposure is outside the camera's limits.
 */
#define FMC_REFUSED_OUTSIDE_LIMITS 3

/**
 * The travel does not fit the stroke.
 */
#define FMC_REFUSED_STROKE 4

/**
 * The speed is beyond the mechanism's.
 */
#define FMC_REFUSED_SPEED 5

/**
 * The stage did not reach its speed in time.
 */
#define FMC_REFUSED_NOT_AT_SPEED 6

/**
 * The shutter did not open.
 */
#define FMC_REFUSED_SHUTTER_MISSING 7

/**
 * A fault ended it before the shutter opened.
 */
#define FMC_REFUSED_FAULT 8

/**
 * It was disarmed before the shutter opened.
 */
#define FMC_REFUSED_DISARMED 9

/**
 * Too many records had not been acknowledged.
 */
#define FMC_REFUSED_RECORDS_FULL 10

/**
 * The shutter opened, but no interior orientation can be given.
 */
#define FMC_REFUSED_UNUSABLE 11

/**
 * V/H from a sensor of V/H.
 */
#define FMC_VH_DIRECT 0

/**
 * V/H from speed and a height above ground.
 */
#define FMC_VH_ALTIMETER 1

/**
 * V/H from speed, altitude and terrain.
 */
#define FMC_VH_TERRAIN 2

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Validates the bytes of a calibration and puts the camera into storage. The bytes are those that
 * the link loads and `fmc_camera_record_to_blob` writes, `crc32` is their CRC-32, `storage` where
 * they are kept. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `count` of them.
 */
fmc_status fmc_camera_init_from_blob(struct fmc_camera *camera,
                                     const uint8_t *bytes,
                                     size_t count,
                                     uint32_t crc32,
                                     fmc_code storage,
                                     struct fmc_error *error);

/**
 * Writes the bytes of a camera's record, and returns their number and CRC-32. Up to
 * `FMC_BLOB_CAPACITY` are needed.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `capacity` of them.
 */
fmc_status fmc_camera_record_to_blob(const struct fmc_camera_record *record,
                                     uint8_t *bytes,
                                     size_t capacity,
                                     size_t *count,
                                     uint32_t *crc32,
                                     struct fmc_error *error);

/**
 * Fills a record with the defaults of a camera file. `size` is that of the structure, `version` is
 * `FMC_CAMERA_VERSION`. Principal distance, sides and pixel remain to be filled.
 *
 * # Safety
 * Unless it is NULL or misaligned, `record` is to `size` bytes of the caller.
 */
fmc_status fmc_camera_record_defaults(struct fmc_camera_record *record,
                                      uint32_t size,
                                      uint32_t version,
                                      struct fmc_error *error);

/**
 * Validates a record and puts the camera into storage. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_camera_init(struct fmc_camera *camera,
                           const struct fmc_camera_record *record,
                           struct fmc_error *error);

/**
 * Returns the identity of a camera's calibration: frames of cameras with the same CRC-32 are
 * exchangeable.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_camera_id(const struct fmc_camera *camera,
                         struct fmc_calibration_id *id,
                         struct fmc_error *error);

/**
 * Writes the sentence of an error, with a zero at its end, cut if the buffer is smaller. Returns
 * the length of the whole sentence without the zero; 0 for a NULL or misaligned error. With `size`
 * 0 nothing is written.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `buffer` to `size`
 * characters.
 */
size_t fmc_error_text(const struct fmc_error *error, char *buffer, size_t size);

/**
 * Writes the name of a quantity, as `fmc_error_text` writes a sentence; returns 0 for a number
 * that is none.
 *
 * # Safety
 * Unless it is NULL, `buffer` is to `size` characters of the caller.
 */
size_t fmc_quantity_name(int32_t quantity, char *buffer, size_t size);

/**
 * Fills an exposure with defaults: planned opening, no focus shift, exact model, forward. `size`
 * is that of the structure, `version` is `FMC_CAMERA_VERSION`. V/H and exposure time remain to be
 * filled.
 *
 * # Safety
 * Unless it is NULL or misaligned, `exposure` is to `size` bytes of the caller.
 */
fmc_status fmc_exposure_defaults(struct fmc_exposure *exposure,
                                 uint32_t size,
                                 uint32_t version,
                                 struct fmc_error *error);

/**
 * Prepares a camera for flight and puts the flight into storage, with a camera of its own, in
 * standby. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_init(struct fmc_flight *flight,
                           const struct fmc_camera *camera,
                           const struct fmc_flight_settings *settings,
                           fmc_code how,
                           struct fmc_error *error);

/**
 * Takes an event, and writes the actions that follow from it, in order. `actions` has room for
 * `FMC_MAX_ACTIONS`, of which `count` are written; without that room the event is not taken.
 *
 * Events come in order of their times. In each round of the control loop, of a millisecond, the
 * flight gets the events since the last round, then `FMC_EVENT_STAGE`, then `FMC_EVENT_TICK`.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `actions` to
 * `FMC_MAX_ACTIONS` of them.
 */
fmc_status fmc_flight_step(struct fmc_flight *flight,
                           const struct fmc_event *event,
                           struct fmc_action *actions,
                           size_t *count,
                           struct fmc_error *error);

/**
 * Returns the state of a flight.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_state(const struct fmc_flight *flight,
                            struct fmc_flight_status *status,
                            struct fmc_error *error);

/**
 * Returns the oldest record with this number or a higher one; `FMC_ERROR_NONE` if there is none.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_record(const struct fmc_flight *flight,
                             uint32_t from_sequence,
                             struct fmc_record *record,
                             struct fmc_error *error);

/**
 * Forgets the records up to this number; their memory is free for others.
 *
 * # Safety
 * Unless it is NULL or misaligned, `flight` is to an object of the caller.
 */
fmc_status fmc_flight_acknowledge(struct fmc_flight *flight,
                                  uint32_t through_sequence,
                                  struct fmc_error *error);

/**
 * Returns the number of the last recorded exposure, and its frame for the correction of its
 * points; `FMC_ERROR_NONE` if there is none. It is a frame of the camera that the flight began with.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_frame(const struct fmc_flight *flight,
                            uint32_t *sequence,
                            struct fmc_frame *frame,
                            struct fmc_error *error);

/**
 * Returns the set point of a time as `FMC_ACTION_MOVE_STAGE`, or `FMC_ACTION_RELEASE_STAGE`: a drive
 * with a faster clock than the control loop asks for it.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_setpoint(const struct fmc_flight *flight,
                               uint64_t time_us,
                               struct fmc_action *action,
                               struct fmc_error *error);

/**
 * Fills settings with their defaults. `size` is that of the structure, `version` is
 * `FMC_CAMERA_VERSION`.
 *
 * # Safety
 * Unless it is NULL or misaligned, `settings` is to `size` bytes of the caller.
 */
fmc_status fmc_flight_settings_defaults(struct fmc_flight_settings *settings,
                                        uint32_t size,
                                        uint32_t version,
                                        struct fmc_error *error);

/**
 * Predicts the frame of an exposure and puts it into storage, where it remains the camera's as
 * long as the camera has this calibration. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_frame_init(struct fmc_frame *frame,
                          const struct fmc_camera *camera,
                          const struct fmc_exposure *exposure,
                          struct fmc_error *error);

/**
 * Returns the interior orientation of a frame.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_frame_interior(const struct fmc_frame *frame,
                              struct fmc_interior *interior,
                              struct fmc_error *error);

/**
 * Validates the bytes of a calibration and puts the camera into storage. The bytes are those that
 * the link loads and `fmc_camera_record_to_blob` writes, `crc32` is their CRC-32, `storage` where
 * they are kept. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `count` of them.
 */
fmc_status fmc_camera_init_from_blob(struct fmc_camera *camera,
                                     const uint8_t *bytes,
                                     size_t count,
                                     uint32_t crc32,
                                     fmc_code storage,
                                     struct fmc_error *error);

/**
 * Writes the bytes of a camera's record, and returns their number and CRC-32. Up to
 * `FMC_BLOB_CAPACITY` are needed.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `capacity` of them.
 */
fmc_status fmc_camera_record_to_blob(const struct fmc_camera_record *record,
                                     uint8_t *bytes,
                                     size_t capacity,
                                     size_t *count,
                                     uint32_t *crc32,
                                     struct fmc_error *error);

/**
 * Fills a record with the defaults of a camera file. `size` is that of the structure, `version` is
 * `FMC_CAMERA_VERSION`. Principal distance, sides and pixel remain to be filled.
 *
 * # Safety
 * Unless it is NULL or misaligned, `record` is to `size` bytes of the caller.
 */
fmc_status fmc_camera_record_defaults(struct fmc_camera_record *record,
                                      uint32_t size,
                                      uint32_t version,
                                      struct fmc_error *error);

/**
 * Validates a record and puts the camera into storage. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_camera_init(struct fmc_camera *camera,
                           const struct fmc_camera_record *record,
                           struct fmc_error *error);

/**
 * Returns the identity of a camera's calibration: frames of cameras with the same CRC-32 are
 * exchangeable.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_camera_id(const struct fmc_camera *camera,
                         struct fmc_calibration_id *id,
                         struct fmc_error *error);

/**
 * Returns the element of an index, which the link check must find: it panics beyond the last.
 *
 * # Safety
 * There are `count` elements.
 */
uint8_t fmc_can_panic(const uint8_t *elements, size_t count, size_t index);

/**
 * Corrects points as `fmc_correct` does, behind its checks: the difference of both is what a call
 * from C costs.
 *
 * # Safety
 * All pointers are to initialised objects, `points` to `count` of them.
 */
void fmc_bare_correct(const struct fmc_frame *frame, struct fmc_point *points, size_t count);

/**
 * Writes the sentence of an error, with a zero at its end, cut if the buffer is smaller. Returns
 * the length of the whole sentence without the zero; 0 for a NULL or misaligned error. With `size`
 * 0 nothing is written.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `buffer` to `size`
 * characters.
 */
size_t fmc_error_text(const struct fmc_error *error, char *buffer, size_t size);

/**
 * Writes the name of a quantity, as `fmc_error_text` writes a sentence; returns 0 for a number
 * that is none.
 *
 * # Safety
 * Unless it is NULL, `buffer` is to `size` characters of the caller.
 */
size_t fmc_quantity_name(int32_t quantity, char *buffer, size_t size);

/**
 * Fills an exposure with defaults: planned opening, no focus shift, exact model, forward. `size`
 * is that of the structure, `version` is `FMC_CAMERA_VERSION`. V/H and exposure time remain to be
 * filled.
 *
 * # Safety
 * Unless it is NULL or misaligned, `exposure` is to `size` bytes of the caller.
 */
fmc_status fmc_exposure_defaults(struct fmc_exposure *exposure,
                                 uint32_t size,
                                 uint32_t version,
                                 struct fmc_error *error);

/**
 * Prepares a camera for flight and puts the flight into storage, with a camera of its own, in
 * standby. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_init(struct fmc_flight *flight,
                           const struct fmc_camera *camera,
                           const struct fmc_flight_settings *settings,
                           fmc_code how,
                           struct fmc_error *error);

/**
 * Takes an event, and writes the actions that follow from it, in order. `actions` has room for
 * `FMC_MAX_ACTIONS`, of which `count` are written; without that room the event is not taken.
 *
 * Events come in order of their times. In each round of the control loop, of a millisecond, the
 * flight gets the events since the last round, then `FMC_EVENT_STAGE`, then `FMC_EVENT_TICK`.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `actions` to
 * `FMC_MAX_ACTIONS` of them.
 */
fmc_status fmc_flight_step(struct fmc_flight *flight,
                           const struct fmc_event *event,
                           struct fmc_action *actions,
                           size_t *count,
                           struct fmc_error *error);

/**
 * Returns the state of a flight.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_state(const struct fmc_flight *flight,
                            struct fmc_flight_status *status,
                            struct fmc_error *error);

/**
 * Returns the oldest record with this number or a higher one; `FMC_ERROR_NONE` if there is none.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_record(const struct fmc_flight *flight,
                             uint32_t from_sequence,
                             struct fmc_record *record,
                             struct fmc_error *error);

/**
 * Forgets the records up to this number; their memory is free for others.
 *
 * # Safety
 * Unless it is NULL or misaligned, `flight` is to an object of the caller.
 */
fmc_status fmc_flight_acknowledge(struct fmc_flight *flight,
                                  uint32_t through_sequence,
                                  struct fmc_error *error);

/**
 * Returns the number of the last recorded exposure, and its frame for the correction of its
 * points; `FMC_ERROR_NONE` if there is none. It is a frame of the camera that the flight began with.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_frame(const struct fmc_flight *flight,
                            uint32_t *sequence,
                            struct fmc_frame *frame,
                            struct fmc_error *error);

/**
 * Returns the set point of a time as `FMC_ACTION_MOVE_STAGE`, or `FMC_ACTION_RELEASE_STAGE`: a drive
 * with a faster clock than the control loop asks for it.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_flight_setpoint(const struct fmc_flight *flight,
                               uint64_t time_us,
                               struct fmc_action *action,
                               struct fmc_error *error);

/**
 * Fills settings with their defaults. `size` is that of the structure, `version` is
 * `FMC_CAMERA_VERSION`.
 *
 * # Safety
 * Unless it is NULL or misaligned, `settings` is to `size` bytes of the caller.
 */
fmc_status fmc_flight_settings_defaults(struct fmc_flight_settings *settings,
                                        uint32_t size,
                                        uint32_t version,
                                        struct fmc_error *error);

/**
 * Predicts the frame of an exposure and puts it into storage, where it remains the camera's as
 * long as the camera has this calibration. After a refusal the storage is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_frame_init(struct fmc_frame *frame,
                          const struct fmc_camera *camera,
                          const struct fmc_exposure *exposure,
                          struct fmc_error *error);

/**
 * Returns the interior orientation of a frame.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_frame_interior(const struct fmc_frame *frame,
                              struct fmc_interior *interior,
                              struct fmc_error *error);

/**
 * Prepares the rows of a frame with `step_mm` from point to point along x, and puts them into
 * storage. `bound_nm` gets the bound of the rounding error of a displacement, nm per axis.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_mesh_init(struct fmc_mesh *mesh,
                         const struct fmc_camera *camera,
                         const struct fmc_frame *frame,
                         float step_mm,
                         float *bound_nm,
                         struct fmc_error *error);

/**
 * Writes the displacements of the points of a row, of which the first is at `first`. `count` may
 * be 0; then `row` may be anything.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `row` to `count`
 * of them.
 */
fmc_status fmc_mesh_row(const struct fmc_camera *camera,
                        const struct fmc_mesh *mesh,
                        struct fmc_point first,
                        struct fmc_displacement *row,
                        size_t count,
                        struct fmc_error *error);

/**
 * Replaces measured points by their ideal points, every one for itself. Points beyond the sensor
 * are extrapolated, and a NaN stays a NaN. `count` may be 0; then `points` may be anything.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `points` to
 * `count` of them.
 */
fmc_status fmc_correct(const struct fmc_camera *camera,
                       const struct fmc_frame *frame,
                       struct fmc_point *points,
                       size_t count,
                       struct fmc_error *error);

/**
 * Does the same as `fmc_correct` for separate coordinates.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `x_mm` and `y_mm`
 * to `count` of them.
 */
fmc_status fmc_correct_xy(const struct fmc_camera *camera,
                          const struct fmc_frame *frame,
                          float *x_mm,
                          float *y_mm,
                          size_t count,
                          struct fmc_error *error);

/**
 * Replaces ideal points by their measured points, which must be on the sensor. If one has none,
 * the error holds its index: those before it have been replaced, it and those behind have not.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `points` to
 * `count` of them.
 */
fmc_status fmc_distort(const struct fmc_camera *camera,
                       const struct fmc_frame *frame,
                       struct fmc_point *points,
                       size_t count,
                       struct fmc_error *error);

/**
 * Does the same as `fmc_distort` for separate coordinates.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `x_mm` and `y_mm`
 * to `count` of them.
 */
fmc_status fmc_distort_xy(const struct fmc_camera *camera,
                          const struct fmc_frame *frame,
                          float *x_mm,
                          float *y_mm,
                          size_t count,
                          struct fmc_error *error);

/**
 * Writes a record as bytes, and returns their number and CRC-32. Up to `FMC_RECORD_CAPACITY` are
 * needed.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `capacity` of them.
 */
fmc_status fmc_record_to_bytes(const struct fmc_record *record,
                               uint8_t *bytes,
                               size_t capacity,
                               size_t *count,
                               uint32_t *crc32,
                               struct fmc_error *error);

/**
 * Reads a record from its bytes, whose CRC-32 is `crc32`. After a refusal the record is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `count` of them.
 */
fmc_status fmc_record_from_bytes(struct fmc_record *record,
                                 const uint8_t *bytes,
                                 size_t count,
                                 uint32_t crc32,
                                 struct fmc_error *error);

/**
 * Returns the version of the library: that of the header that belongs to it.
 */
uint32_t fmc_camera_version(void);

/**
 * Prepares the rows of a frame with `step_mm` from point to point along x, and puts them into
 * storage. `bound_nm` gets the bound of the rounding error of a displacement, nm per axis.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller.
 */
fmc_status fmc_mesh_init(struct fmc_mesh *mesh,
                         const struct fmc_camera *camera,
                         const struct fmc_frame *frame,
                         float step_mm,
                         float *bound_nm,
                         struct fmc_error *error);

/**
 * Writes the displacements of the points of a row, of which the first is at `first`. `count` may
 * be 0; then `row` may be anything.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `row` to `count`
 * of them.
 */
fmc_status fmc_mesh_row(const struct fmc_camera *camera,
                        const struct fmc_mesh *mesh,
                        struct fmc_point first,
                        struct fmc_displacement *row,
                        size_t count,
                        struct fmc_error *error);

/**
 * Replaces measured points by their ideal points, every one for itself. Points beyond the sensor
 * are extrapolated, and a NaN stays a NaN. `count` may be 0; then `points` may be anything.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `points` to
 * `count` of them.
 */
fmc_status fmc_correct(const struct fmc_camera *camera,
                       const struct fmc_frame *frame,
                       struct fmc_point *points,
                       size_t count,
                       struct fmc_error *error);

/**
 * Does the same as `fmc_correct` for separate coordinates.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `x_mm` and `y_mm`
 * to `count` of them.
 */
fmc_status fmc_correct_xy(const struct fmc_camera *camera,
                          const struct fmc_frame *frame,
                          float *x_mm,
                          float *y_mm,
                          size_t count,
                          struct fmc_error *error);

/**
 * Replaces ideal points by their measured points, which must be on the sensor. If one has none,
 * the error holds its index: those before it have been replaced, it and those behind have not.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `points` to
 * `count` of them.
 */
fmc_status fmc_distort(const struct fmc_camera *camera,
                       const struct fmc_frame *frame,
                       struct fmc_point *points,
                       size_t count,
                       struct fmc_error *error);

/**
 * Does the same as `fmc_distort` for separate coordinates.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `x_mm` and `y_mm`
 * to `count` of them.
 */
fmc_status fmc_distort_xy(const struct fmc_camera *camera,
                          const struct fmc_frame *frame,
                          float *x_mm,
                          float *y_mm,
                          size_t count,
                          struct fmc_error *error);

/**
 * Writes a record as bytes, and returns their number and CRC-32. Up to `FMC_RECORD_CAPACITY` are
 * needed.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `capacity` of them.
 */
fmc_status fmc_record_to_bytes(const struct fmc_record *record,
                               uint8_t *bytes,
                               size_t capacity,
                               size_t *count,
                               uint32_t *crc32,
                               struct fmc_error *error);

/**
 * Reads a record from its bytes, whose CRC-32 is `crc32`. After a refusal the record is as before.
 *
 * # Safety
 * Unless they are NULL or misaligned, the pointers are to objects of the caller, `bytes` to
 * `count` of them.
 */
fmc_status fmc_record_from_bytes(struct fmc_record *record,
                                 const uint8_t *bytes,
                                 size_t count,
                                 uint32_t crc32,
                                 struct fmc_error *error);

/**
 * Returns the version of the library: that of the header that belongs to it.
 */
uint32_t fmc_camera_version(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FMC_CAMERA_H */
