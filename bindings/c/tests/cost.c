/* What calls cost on a Cortex-M4F in QEMU: instructions over the bare correction, and stack.
 *
 * It prints lines `name,number`. Under `-icount shift=0` an instruction takes 1 ns, and the system
 * timer counts 40 of them to a tick. */
#include "fmc_camera.h"
#include "print.h"

void fmc_bare_correct(const fmc_frame *frame, fmc_point *points, size_t count);

#define CALLS 4096u
#define POINTS 16u
#define PER_TICK 40u
#define PAINT 0xA5C3A5C3u

extern uint32_t stack_bottom;

static fmc_camera_record record;
static fmc_exposure exposure;
static fmc_flight_settings settings;
static fmc_camera camera;
static fmc_frame frame;
static fmc_mesh mesh;
static fmc_flight flight;
static fmc_record kept;
static fmc_interior interior;
static fmc_flight_status state;
static fmc_calibration_id id;
static fmc_point points[POINTS];
static fmc_displacement row[POINTS];
static float x_mm[POINTS];
static float y_mm[POINTS];
static uint8_t bytes[FMC_BLOB_CAPACITY];
static fmc_action actions[FMC_MAX_ACTIONS];
static fmc_event event;
static fmc_error error;
static size_t count;
static uint32_t crc32;
static uint32_t sequence;
static float bound_nm;
static char text[200];

static void print_amount(const char *name, uint32_t amount) {
  platform_write(name);
  platform_write(",");
  print_number(amount);
  platform_write("\n");
}

static volatile uint32_t *const timer_control = (volatile uint32_t *)0xE000E010u;
static volatile uint32_t *const timer_reload = (volatile uint32_t *)0xE000E014u;
static volatile uint32_t *const timer_value = (volatile uint32_t *)0xE000E018u;

static void with_checks(void) { (void)fmc_correct(&camera, &frame, points, POINTS, &error); }

static void bare(void) { fmc_bare_correct(&frame, points, POINTS); }

/* Returns the instructions of CALLS calls. */
static uint32_t instructions(void (*call)(void)) {
  uint32_t i;
  *timer_value = 0u;
  for (i = 0u; i < CALLS; i++) {
    call();
  }
  return (0xFFFFFFu - *timer_value) * PER_TICK;
}

static void camera_init(void) { (void)fmc_camera_init(&camera, &record, &error); }
static void from_blob(void) {
  (void)fmc_camera_init_from_blob(&camera, bytes, count, crc32, FMC_STORED, &error);
}
static void to_blob(void) {
  (void)fmc_camera_record_to_blob(&record, bytes, sizeof bytes, &count, &crc32, &error);
}
static void camera_id(void) { (void)fmc_camera_id(&camera, &id, &error); }
static void frame_init(void) { (void)fmc_frame_init(&frame, &camera, &exposure, &error); }
static void frame_interior(void) { (void)fmc_frame_interior(&frame, &interior, &error); }
static void distort(void) { (void)fmc_distort(&camera, &frame, points, POINTS, &error); }
static void correct_xy(void) {
  (void)fmc_correct_xy(&camera, &frame, x_mm, y_mm, POINTS, &error);
}
static void distort_xy(void) {
  (void)fmc_distort_xy(&camera, &frame, x_mm, y_mm, POINTS, &error);
}
static void mesh_init(void) {
  (void)fmc_mesh_init(&mesh, &camera, &frame, 0.5f, &bound_nm, &error);
}
static void mesh_row(void) {
  (void)fmc_mesh_row(&camera, &mesh, points[0], row, POINTS, &error);
}
static void flight_init(void) {
  (void)fmc_flight_init(&flight, &camera, &settings, FMC_START_ORDERLY, &error);
}
/* A flight that is armed, is triggered and is given its tick. */
static void flight_step(void) {
  static const fmc_code kinds[] = {FMC_EVENT_VH,   FMC_EVENT_STAGE,   FMC_EVENT_ARM,
                                   FMC_EVENT_TICK, FMC_EVENT_TRIGGER, FMC_EVENT_TICK};
  unsigned int i;
  event.values[0] = 0.1f;
  for (i = 0u; i < sizeof kinds / sizeof kinds[0]; i++) {
    event.kind = kinds[i];
    (void)fmc_flight_step(&flight, &event, actions, &count, &error);
  }
}
static void flight_record(void) { (void)fmc_flight_record(&flight, 1u, &kept, &error); }
static void flight_state(void) { (void)fmc_flight_state(&flight, &state, &error); }
static void flight_frame(void) { (void)fmc_flight_frame(&flight, &sequence, &frame, &error); }
static void acknowledge(void) { (void)fmc_flight_acknowledge(&flight, 1u, &error); }
static void setpoint(void) { (void)fmc_flight_setpoint(&flight, 0u, actions, &error); }
static void to_bytes(void) {
  (void)fmc_record_to_bytes(&kept, bytes, sizeof bytes, &count, &crc32, &error);
}
static void from_bytes(void) {
  (void)fmc_record_from_bytes(&kept, bytes, count, crc32, &error);
}
static void error_text(void) {
  error.status = FMC_ERROR_STROKE;
  (void)fmc_error_text(&error, text, sizeof text);
}

/* Prints the stack of a call, this function's own included: every word that lost its paint. */
static void print_stack(const char *name, void (*call)(void)) {
  volatile uint32_t *address = &stack_bottom;
  uint32_t *here;
  __asm__ volatile("mov %0, sp" : "=r"(here));
  while (address < here) {
    *address = PAINT;
    address++;
  }
  call();
  address = &stack_bottom;
  while (address < here && *address == PAINT) {
    address++;
  }
  print_amount(name, (uint32_t)(here - address) * 4u);
}

int main(void) {
  uint32_t checked;
  uint32_t unchecked;
  (void)fmc_camera_record_defaults(&record, sizeof record, FMC_CAMERA_VERSION, &error);
  (void)fmc_exposure_defaults(&exposure, sizeof exposure, FMC_CAMERA_VERSION, &error);
  (void)fmc_flight_settings_defaults(&settings, sizeof settings, FMC_CAMERA_VERSION, &error);
  record.principal_distance_mm = 51.3712f;
  record.width_px = 14204u;
  record.height_px = 10652u;
  record.pixel_um = 3.76f;
  record.k1 = -1.6056e-5f;
  record.k2 = 6.18966e-9f;
  record.k3 = -1.31329e-12f;
  exposure.vh_per_s = 0.1f;
  exposure.exposure_s = 0.004f;

  print_stack("stack fmc_camera_init", camera_init);
  print_stack("stack fmc_camera_record_to_blob", to_blob);
  print_stack("stack fmc_camera_init_from_blob", from_blob);
  print_stack("stack fmc_camera_id", camera_id);
  print_stack("stack fmc_frame_init", frame_init);
  print_stack("stack fmc_frame_interior", frame_interior);
  print_stack("stack fmc_correct", with_checks);
  print_stack("stack fmc_correct_xy", correct_xy);
  print_stack("stack fmc_distort", distort);
  print_stack("stack fmc_distort_xy", distort_xy);
  print_stack("stack fmc_mesh_init", mesh_init);
  print_stack("stack fmc_mesh_row", mesh_row);
  print_stack("stack fmc_flight_init", flight_init);
  print_stack("stack fmc_flight_step", flight_step);
  print_stack("stack fmc_flight_state", flight_state);
  print_stack("stack fmc_flight_record", flight_record);
  print_stack("stack fmc_flight_frame", flight_frame);
  print_stack("stack fmc_flight_acknowledge", acknowledge);
  print_stack("stack fmc_flight_setpoint", setpoint);
  print_stack("stack fmc_record_to_bytes", to_bytes);
  print_stack("stack fmc_record_from_bytes", from_bytes);
  print_stack("stack fmc_error_text", error_text);

  *timer_reload = 0xFFFFFFu;
  *timer_control = 5u;
  if (fmc_correct(&camera, &frame, points, POINTS, &error) != FMC_OK) {
    return 1;
  }
  checked = instructions(with_checks);
  unchecked = instructions(bare);
  print_amount("instructions fmc_correct", checked / CALLS);
  print_amount("instructions over correct_slice", (checked - unchecked + CALLS - 1u) / CALLS);
  return 0;
}
