/* The camera in C: a calibration, the frames of exposures, and the correction of points.
 *
 * It prints a digest of the bits of all coordinates. They are those of the library in Rust on every
 * machine (tests/example.rs). */
#include "fmc_camera.h"
#include "print.h"

/* Points of a grid over the sensor, and exposures. */
#define SIDE 21
#define POINTS (SIDE * SIDE)
#define SPEEDS 6
#define TIMES 10

static fmc_camera camera;
static fmc_frame frame;
static fmc_mesh mesh;
static fmc_point points[POINTS];
static fmc_point apart[POINTS];
static float x_mm[POINTS];
static float y_mm[POINTS];
static fmc_displacement row[SIDE];

/* Prints the sentence of an error and returns 1. */
static int refused(const fmc_error *error) {
  char text[256];
  (void)fmc_error_text(error, text, sizeof text);
  platform_write(text);
  platform_write("\n");
  return 1;
}

static fmc_status load(fmc_error *error) {
  fmc_camera_record record;
  uint8_t blob[FMC_BLOB_CAPACITY];
  size_t count = 0u;
  uint32_t crc32 = 0u;
  fmc_status status =
      fmc_camera_record_defaults(&record, sizeof record, FMC_CAMERA_VERSION, error);
  if (status != FMC_OK) {
    return status;
  }
  record.principal_distance_mm = 51.3712f;
  record.width_px = 14204u;
  record.height_px = 10652u;
  record.pixel_um = 3.76f;
  record.principal_point_x_mm = 0.0125f;
  record.principal_point_y_mm = -0.03f;
  record.k1 = -1.6056e-5f;
  record.k2 = 6.18966e-9f;
  record.k3 = -1.31329e-12f;
  record.p1 = 2e-6f;
  record.p2 = -4.5e-6f;
  record.limits_vh_per_s[0] = 0.02f;
  record.limits_vh_per_s[1] = 0.2f;
  record.serial[0] = 'C';
  record.serial[1] = '1';
  record.calibration_version = 3u;
  status = fmc_camera_init(&camera, &record, error);
  if (status != FMC_OK) {
    return status;
  }
  /* The same calibration as the bytes of the board's store. */
  status = fmc_camera_record_to_blob(&record, blob, sizeof blob, &count, &crc32, error);
  if (status != FMC_OK) {
    return status;
  }
  print_line("blob", (uint32_t)count, crc32);
  return fmc_camera_init_from_blob(&camera, blob, count, crc32, FMC_STORED, error);
}

static void lay_grid(void) {
  int column;
  int line;
  for (line = 0; line < SIDE; line++) {
    for (column = 0; column < SIDE; column++) {
      fmc_point *point = &points[line * SIDE + column];
      point->x_mm = 2.625f * (float)(column - 10);
      point->y_mm = 2.0f * (float)(line - 10);
    }
  }
}

int main(void) {
  fmc_error error;
  fmc_exposure exposure;
  uint32_t corrected = DIGEST_BEGIN;
  uint32_t distorted = DIGEST_BEGIN;
  uint32_t interiors = DIGEST_BEGIN;
  uint32_t rows = DIGEST_BEGIN;
  int speed;
  int time;
  int i;

  if (load(&error) != FMC_OK) {
    return refused(&error);
  }
  if (fmc_exposure_defaults(&exposure, sizeof exposure, FMC_CAMERA_VERSION, &error) != FMC_OK) {
    return refused(&error);
  }
  for (speed = 0; speed < SPEEDS; speed++) {
    for (time = 0; time < TIMES; time++) {
      fmc_interior interior;
      fmc_point first = {-26.25f, 7.0f};
      float bound_nm;
      exposure.vh_per_s = 0.02f + 0.03f * (float)speed;
      exposure.exposure_s = 0.0005f + 0.0005f * (float)time;
      exposure.direction = (time % 2) == 0 ? FMC_FORWARD : FMC_REVERSE;
      if (fmc_frame_init(&frame, &camera, &exposure, &error) != FMC_OK ||
          fmc_frame_interior(&frame, &interior, &error) != FMC_OK) {
        return refused(&error);
      }
      interiors = digest(interiors, &interior.centroid_mm, sizeof interior.centroid_mm);
      interiors = digest(interiors, &interior.left_out_nm, sizeof interior.left_out_nm);

      lay_grid();
      for (i = 0; i < POINTS; i++) {
        x_mm[i] = points[i].x_mm;
        y_mm[i] = points[i].y_mm;
      }
      if (fmc_correct(&camera, &frame, points, POINTS, &error) != FMC_OK ||
          fmc_correct_xy(&camera, &frame, x_mm, y_mm, POINTS, &error) != FMC_OK) {
        return refused(&error);
      }
      for (i = 0; i < POINTS; i++) {
        apart[i].x_mm = x_mm[i];
        apart[i].y_mm = y_mm[i];
      }
      corrected = digest(corrected, points, sizeof points);
      if (digest(DIGEST_BEGIN, apart, sizeof apart) !=
          digest(DIGEST_BEGIN, points, sizeof points)) {
        platform_write("x and y apart are others than pairs\n");
        return 1;
      }
      if (fmc_distort(&camera, &frame, points, POINTS, &error) != FMC_OK ||
          fmc_distort_xy(&camera, &frame, x_mm, y_mm, POINTS, &error) != FMC_OK) {
        return refused(&error);
      }
      for (i = 0; i < POINTS; i++) {
        apart[i].x_mm = x_mm[i];
        apart[i].y_mm = y_mm[i];
      }
      distorted = digest(distorted, points, sizeof points);
      if (digest(DIGEST_BEGIN, apart, sizeof apart) !=
          digest(DIGEST_BEGIN, points, sizeof points)) {
        platform_write("x and y apart are others than pairs\n");
        return 1;
      }
      if (fmc_mesh_init(&mesh, &camera, &frame, 2.625f, &bound_nm, &error) != FMC_OK ||
          fmc_mesh_row(&camera, &mesh, first, row, SIDE, &error) != FMC_OK) {
        return refused(&error);
      }
      rows = digest(rows, row, sizeof row);
    }
  }
  print_line("interior", SPEEDS * TIMES, interiors);
  print_line("corrected", SPEEDS * TIMES * POINTS, corrected);
  print_line("distorted", SPEEDS * TIMES * POINTS, distorted);
  print_line("mesh", SPEEDS * TIMES * SIDE, rows);
  return 0;
}
