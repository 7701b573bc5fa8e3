/* Every wrong call of the library has a defined answer: its status, and its sentence. */
#include "fmc_camera.h"
#include "print.h"

#define POINTS 4

static fmc_camera_record record;
static fmc_exposure exposure;
static fmc_camera camera;
static fmc_camera other;
static fmc_camera blank;
static fmc_frame frame;
static fmc_frame unset;
static fmc_mesh mesh;
static fmc_flight flight;
static fmc_point points[POINTS + 1];
static float numbers[2 * POINTS];
static fmc_displacement row[POINTS];
static uint8_t bytes[FMC_RECORD_CAPACITY];
static int failures;

/* Fills an error with what no call leaves. */
static fmc_error empty(void) {
  fmc_error error;
  error.status = -1;
  error.quantity = -2;
  return error;
}

static void check(const char *name, fmc_status status, fmc_status expected,
                  const fmc_error *error) {
  char text[300];
  platform_write(name);
  platform_write(": ");
  if (status != expected || (status != FMC_OK && error->status != status)) {
    failures++;
    platform_write("WRONG STATUS ");
    print_number((uint32_t)status);
    platform_write(" ");
  }
  if (status == FMC_OK) {
    platform_write("done\n");
    return;
  }
  (void)fmc_error_text(error, text, sizeof text);
  platform_write(text);
  platform_write("\n");
}

/* Checks a call, which fills `error`. */
#define CHECK(name, call, expected)       \
  do {                                    \
    fmc_error error = empty();            \
    fmc_status status = (call);           \
    check(name, status, expected, &error); \
  } while (0)

static uint32_t bits_of_points(void) { return digest(DIGEST_BEGIN, points, sizeof points); }

static void lay_points(void) {
  int i;
  for (i = 0; i <= POINTS; i++) {
    points[i].x_mm = (float)i;
    points[i].y_mm = -2.0f * (float)i;
  }
}

static void pointers(void) {
  /* Addresses within one object, so that C allows them. */
  fmc_camera *odd = (fmc_camera *)(void *)((unsigned char *)&blank + 4);
  float *odd_number = (float *)(void *)((unsigned char *)numbers + 1);
  fmc_point *odd_points = (fmc_point *)(void *)((unsigned char *)points + 2);
  uint32_t before = bits_of_points();

  CHECK("record NULL", fmc_camera_init(&other, NULL, &error), FMC_ERROR_NULL);
  CHECK("camera NULL", fmc_camera_init(NULL, &record, &error), FMC_ERROR_NULL);
  CHECK("camera misaligned", fmc_camera_init(odd, &record, &error), FMC_ERROR_MISALIGNED);
  CHECK("frame NULL", fmc_correct(&camera, NULL, points, POINTS, &error), FMC_ERROR_NULL);
  CHECK("points NULL", fmc_correct(&camera, &frame, NULL, 1u, &error), FMC_ERROR_NULL);
  CHECK("points misaligned", fmc_correct(&camera, &frame, odd_points, POINTS, &error),
        FMC_ERROR_MISALIGNED);
  CHECK("x misaligned",
        fmc_correct_xy(&camera, &frame, odd_number, &numbers[POINTS], 1u, &error), FMC_ERROR_MISALIGNED);
  CHECK("x and y overlap",
        fmc_correct_xy(&camera, &frame, numbers, &numbers[POINTS - 1], POINTS, &error),
        FMC_ERROR_OVERLAP);
  CHECK("x is y", fmc_distort_xy(&camera, &frame, numbers, numbers, POINTS, &error),
        FMC_ERROR_OVERLAP);
  CHECK("points overlap frame",
        fmc_correct(&camera, &frame, (fmc_point *)(void *)&frame, 1u, &error),
        FMC_ERROR_OVERLAP);
  CHECK("points overlap camera",
        fmc_distort(&camera, &frame, (fmc_point *)(void *)&camera.opaque[1], 1u, &error),
        FMC_ERROR_OVERLAP);
  CHECK("frame overlaps camera",
        fmc_frame_init((fmc_frame *)(void *)&camera, &camera, &exposure, &error),
        FMC_ERROR_OVERLAP);
  CHECK("row overlaps mesh",
        fmc_mesh_row(&camera, &mesh, points[0], (fmc_displacement *)(void *)&mesh, 1u, &error),
        FMC_ERROR_OVERLAP);
  CHECK("more than memory", fmc_correct(&camera, &frame, points, (size_t)-1, &error),
        FMC_ERROR_TOO_MANY);
  CHECK("no points", fmc_correct(&camera, &frame, NULL, 0u, &error), FMC_OK);
  CHECK("no points, misaligned", fmc_correct(&camera, &frame, odd_points, 0u, &error), FMC_OK);
  CHECK("no x and y", fmc_distort_xy(&camera, &frame, NULL, NULL, 0u, &error), FMC_OK);
  CHECK("no row", fmc_mesh_row(&camera, &mesh, points[0], NULL, 0u, &error), FMC_OK);
  if (fmc_correct(&camera, NULL, points, POINTS, NULL) != FMC_ERROR_NULL) {
    failures++;
    platform_write("error NULL: WRONG\n");
  }
  if (bits_of_points() != before) {
    failures++;
    platform_write("points were changed by a refusal: WRONG\n");
  }
}

static void structures(void) {
  fmc_camera_record wrong = record;
  fmc_exposure later = exposure;
  wrong.size = (uint32_t)sizeof wrong - 4u;
  CHECK("record of another size", fmc_camera_init(&other, &wrong, &error),
        FMC_ERROR_STRUCT_SIZE);
  wrong.size = (uint32_t)sizeof wrong;
  wrong.version = 0x00000200u;
  CHECK("record of another header", fmc_camera_init(&other, &wrong, &error), FMC_ERROR_VERSION);
  CHECK("defaults of another size", fmc_exposure_defaults(&later, 8u, FMC_CAMERA_VERSION, &error),
        FMC_ERROR_STRUCT_SIZE);
  CHECK("defaults of another header", fmc_exposure_defaults(&later, sizeof later, 0u, &error),
        FMC_ERROR_VERSION);
  later.size = 0u;
  CHECK("exposure of another size", fmc_frame_init(&unset, &camera, &later, &error),
        FMC_ERROR_STRUCT_SIZE);
  CHECK("camera never initialised", fmc_frame_init(&unset, &blank, &exposure, &error),
        FMC_ERROR_UNINITIALISED);
  CHECK("frame never initialised", fmc_correct(&camera, &unset, points, POINTS, &error),
        FMC_ERROR_UNINITIALISED);
  CHECK("camera in place of a frame",
        fmc_correct(&camera, (const fmc_frame *)(const void *)&camera, points, POINTS, &error),
        FMC_ERROR_UNINITIALISED);
  CHECK("flight never initialised", fmc_flight_acknowledge(&flight, 1u, &error),
        FMC_ERROR_UNINITIALISED);
}

static void changed_camera(void) {
  fmc_camera_record calibrated = record;
  other = camera;
  CHECK("frame of a copied camera", fmc_correct(&other, &frame, points, POINTS, &error), FMC_OK);
  calibrated.k1 = -1.6e-5f;
  CHECK("camera initialised again", fmc_camera_init(&other, &calibrated, &error), FMC_OK);
  CHECK("frame of the camera before", fmc_correct(&other, &frame, points, POINTS, &error),
        FMC_ERROR_CAMERA_CHANGED);
  CHECK("mesh of the camera before", fmc_mesh_row(&other, &mesh, points[0], row, POINTS, &error),
        FMC_ERROR_CAMERA_CHANGED);
  calibrated.k1 = 1.0f;
  CHECK("camera that folds", fmc_camera_init(&other, &calibrated, &error), FMC_ERROR_FOLDS);
  CHECK("camera after a refusal", fmc_frame_init(&unset, &other, &exposure, &error), FMC_OK);
}

static void values(void) {
  fmc_camera_record wrong = record;
  fmc_exposure late = exposure;
  fmc_point beyond[3];
  wrong.principal_distance_mm = 1.0f;
  CHECK("principal distance", fmc_camera_init(&other, &wrong, &error), FMC_ERROR_OUT_OF_RANGE);
  wrong = record;
  wrong.k2 = (float)(1e30 * 1e30);
  CHECK("infinite k2", fmc_camera_init(&other, &wrong, &error), FMC_ERROR_OUT_OF_RANGE);
  wrong = record;
  wrong.axis = 7;
  CHECK("axis", fmc_camera_init(&other, &wrong, &error), FMC_ERROR_CODE);
  wrong = record;
  wrong.serial[2] = '\n';
  wrong.serial[0] = 'a';
  wrong.serial[1] = 'b';
  CHECK("serial number", fmc_camera_init(&other, &wrong, &error), FMC_ERROR_SERIAL);
  late.vh_per_s = 0.3f;
  CHECK("V/H", fmc_frame_init(&unset, &camera, &late, &error), FMC_ERROR_OUT_OF_RANGE);
  late = exposure;
  late.has_opening_offset = FMC_YES;
  late.opening_offset_mm = 3.0f;
  CHECK("opening offset", fmc_frame_init(&unset, &camera, &late, &error), FMC_ERROR_STROKE);
  late = exposure;
  late.model = FMC_MODEL_FITTED;
  CHECK("no fitted model", fmc_frame_init(&unset, &camera, &late, &error),
        FMC_ERROR_NOT_FITTED);
  wrong = record;
  wrong.max_speed_mm_s = 1.5f;
  CHECK("slow stage", fmc_camera_init(&other, &wrong, &error), FMC_OK);
  CHECK("speed", fmc_frame_init(&unset, &other, &exposure, &error), FMC_ERROR_SPEED);
  beyond[0] = points[0];
  beyond[1].x_mm = 60.0f;
  beyond[1].y_mm = 0.0f;
  beyond[2].x_mm = 3.0f;
  beyond[2].y_mm = 4.0f;
  CHECK("ideal point off the sensor", fmc_distort(&camera, &frame, beyond, 3u, &error),
        FMC_ERROR_OFF_SENSOR);
  if (beyond[2].x_mm != 3.0f || beyond[2].y_mm != 4.0f) {
    failures++;
    platform_write("a point behind the refused one was changed: WRONG\n");
  }
}

/* Initialises a camera from `bytes`, whose CRC-32 the first refusal tells. */
static fmc_status from_bytes(size_t count, fmc_error *error) {
  fmc_status status = fmc_camera_init_from_blob(&other, bytes, count, 0u, 0, error);
  if (status != FMC_ERROR_CRC) {
    return status;
  }
  return fmc_camera_init_from_blob(&other, bytes, count, error->number, 0, error);
}

/* A focus table behind the bytes of a calibration: no grids, two rows of -20 °C, -30 µm and 40 °C,
 * 16 µm. */
static void focus_table(size_t count) {
  static const uint8_t table[19] = {0u, 0u, 2u,    0u, 0u, 0xa0u, 0xc1u, 0u, 0u, 0xf0u,
                                    0xc1u, 0u, 0u, 0x20u, 0x42u, 0u, 0u, 0x80u, 0x41u};
  size_t i;
  for (i = 0u; i < sizeof table; i++) {
    bytes[count + i] = table[i];
  }
  CHECK("blob with a focus table", from_bytes(count + sizeof table, &error), FMC_OK);
  CHECK("focus table cut", from_bytes(count + sizeof table - 1u, &error), FMC_ERROR_GRIDS);
  /* The second temperature falls to -40 °C. */
  bytes[count + 14u] = 0xc2u;
  CHECK("temperature that falls", from_bytes(count + sizeof table, &error),
        FMC_ERROR_OUT_OF_RANGE);
  bytes[count + 2u] = 1u;
  CHECK("focus table of one row", from_bytes(count + 11u, &error), FMC_ERROR_OUT_OF_RANGE);
}

static void flight_settings(void) {
  fmc_flight_settings settings;
  CHECK("settings",
        fmc_flight_settings_defaults(&settings, sizeof settings, FMC_CAMERA_VERSION, &error),
        FMC_OK);
  settings.fitted_model = 2;
  CHECK("neither yes nor no",
        fmc_flight_init(&flight, &camera, &settings, FMC_START_ORDERLY, &error), FMC_ERROR_CODE);
  settings.fitted_model = FMC_YES;
  CHECK("flight by a fitted model that is not there",
        fmc_flight_init(&flight, &camera, &settings, FMC_START_ORDERLY, &error),
        FMC_ERROR_NOT_FITTED);
}

static void blobs(void) {
  size_t count = 0u;
  uint32_t crc32 = 0u;
  fmc_record frame_record;
  struct {
    size_t count;
    uint32_t crc32;
    uint8_t bytes[FMC_RECORD_CAPACITY];
  } numbered;
  CHECK("blob", fmc_camera_record_to_blob(&record, bytes, sizeof bytes, &count, &crc32, &error),
        FMC_OK);
  CHECK("small buffer", fmc_camera_record_to_blob(&record, bytes, 10u, &count, &crc32, &error),
        FMC_ERROR_BUFFER);
  CHECK("bytes overlap record",
        fmc_camera_record_to_blob(&record, (uint8_t *)(void *)&record, sizeof record, &count,
                                  &crc32, &error),
        FMC_ERROR_OVERLAP);
  CHECK("bytes overlap their number",
        fmc_camera_record_to_blob(&record, (uint8_t *)(void *)&numbered, sizeof numbered,
                                  &numbered.count, &crc32, &error),
        FMC_ERROR_OVERLAP);
  CHECK("bytes overlap their CRC-32",
        fmc_camera_record_to_blob(&record, (uint8_t *)(void *)&numbered, sizeof numbered, &count,
                                  &numbered.crc32, &error),
        FMC_ERROR_OVERLAP);
  CHECK("blob cut", fmc_camera_init_from_blob(&other, bytes, count - 1u, crc32, 0, &error),
        FMC_ERROR_BYTES);
  CHECK("empty blob", fmc_camera_init_from_blob(&other, NULL, 0u, crc32, 0, &error),
        FMC_ERROR_BYTES);
  bytes[9] ^= 1u;
  CHECK("blob with a wrong bit", fmc_camera_init_from_blob(&other, bytes, count, crc32, 0, &error),
        FMC_ERROR_CRC);
  bytes[9] ^= 1u;
  bytes[count] = 1u;
  CHECK("blob with grids",
        fmc_camera_init_from_blob(&other, bytes, count + 1u, crc32, 0, &error),
        FMC_ERROR_GRIDS);
  CHECK("storage", fmc_camera_init_from_blob(&other, bytes, count, crc32, 5, &error),
        FMC_ERROR_CODE);
  CHECK("blob whole", fmc_camera_init_from_blob(&other, bytes, count, crc32, 0, &error), FMC_OK);
  CHECK("no record in bytes",
        fmc_record_from_bytes(&frame_record, bytes, 2u, crc32, &error), FMC_ERROR_BYTES);
  focus_table(count);
}

static void texts(void) {
  fmc_error error = empty();
  char text[8];
  size_t length;
  (void)fmc_camera_init(NULL, &record, &error);
  length = fmc_error_text(&error, text, sizeof text);
  platform_write("cut to 8: ");
  platform_write(text);
  platform_write(" of ");
  print_number((uint32_t)length);
  platform_write("\nquantity 0: ");
  if (fmc_error_text(&error, NULL, 0u) != length || fmc_error_text(NULL, text, 8u) != 0u ||
      fmc_quantity_name(-1, text, 8u) != 0u) {
    failures++;
    platform_write("WRONG LENGTH ");
  }
  (void)fmc_quantity_name(0, text, sizeof text);
  platform_write(text);
  platform_write("\n");
}

int main(void) {
  fmc_error error = empty();
  float bound_nm;
  if (fmc_camera_version() != FMC_CAMERA_VERSION) {
    platform_write("header and library differ\n");
    return 1;
  }
  (void)fmc_camera_record_defaults(&record, sizeof record, FMC_CAMERA_VERSION, &error);
  record.principal_distance_mm = 51.3712f;
  record.width_px = 14204u;
  record.height_px = 10652u;
  record.pixel_um = 3.76f;
  record.k1 = -1.6056e-5f;
  record.k2 = 6.18966e-9f;
  record.limits_vh_per_s[1] = 0.2f;
  (void)fmc_exposure_defaults(&exposure, sizeof exposure, FMC_CAMERA_VERSION, &error);
  exposure.vh_per_s = 0.05f;
  exposure.exposure_s = 0.004f;
  CHECK("camera", fmc_camera_init(&camera, &record, &error), FMC_OK);
  CHECK("frame", fmc_frame_init(&frame, &camera, &exposure, &error), FMC_OK);
  CHECK("mesh", fmc_mesh_init(&mesh, &camera, &frame, 0.5f, &bound_nm, &error), FMC_OK);
  lay_points();
  pointers();
  structures();
  changed_camera();
  values();
  blobs();
  flight_settings();
  texts();
  platform_write(failures == 0 ? "all as defined\n" : "NOT AS DEFINED\n");
  return failures;
}
