/* The least program of a camera: initialise, frame, correct, distort. Its size is the library's. */
#include "fmc_camera.h"

static fmc_camera_record record;
static fmc_exposure exposure;
static fmc_camera camera;
static fmc_frame frame;
static fmc_point points[2];

int main(void) {
  fmc_status status = fmc_camera_init(&camera, &record, NULL);
  status |= fmc_frame_init(&frame, &camera, &exposure, NULL);
  status |= fmc_correct(&camera, &frame, points, 2u, NULL);
  status |= fmc_distort(&camera, &frame, points, 2u, NULL);
  return (int)status;
}
