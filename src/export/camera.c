#include "export/camera.h"

/* Height / width of a picture, and the share of it that stays free around what must be in view. */
static const double LEAST_RATIO = 0.6, MOST_RATIO = 1.3, MARGIN = 0.03;
/* Distance of the eye in half diagonals: the nearest point appears at most 5/4 as large as the centre. */
static const double REMOVE = 5.0;

ShvCamera shv_camera_begin(void)
{
    ShvCamera camera = {.toward = shv_unit(shv_vec3(0.42, -0.85, 0.36))};
    camera.right = shv_unit(shv_cross(shv_vec3(0.0, 0.0, 1.0), camera.toward));
    camera.up = shv_cross(camera.toward, camera.right);
    for (int k = 0; k < 3; k++) {
        camera.low[k] = (double)INFINITY;
        camera.high[k] = -(double)INFINITY;
    }
    return camera;
}

void shv_camera_include(ShvCamera *camera, ShvVec3 point)
{
    const double along[3] = {shv_dot(point, camera->right), shv_dot(point, camera->up), shv_dot(point, camera->toward)};
    for (int k = 0; k < 3; k++) {
        camera->low[k] = fmin(camera->low[k], along[k]);
        camera->high[k] = fmax(camera->high[k], along[k]);
    }
}

void shv_camera_aim(ShvCamera *camera, double width)
{
    double half[3] = {0.5, 0.5, 0.5}, middle[3] = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++) {
        if (!(camera->high[k] > camera->low[k])) continue;
        half[k] = 0.5 * (camera->high[k] - camera->low[k]);
        middle[k] = 0.5 * (camera->high[k] + camera->low[k]);
    }
    camera->centre = shv_add(shv_madd(shv_scale(camera->right, middle[0]), middle[1], camera->up),
                             shv_scale(camera->toward, middle[2]));
    camera->distance = REMOVE * shv_norm(shv_vec3(half[0], half[1], half[2]));
    camera->width = width;
    camera->height = floor(width * fmin(MOST_RATIO, fmax(LEAST_RATIO, half[1] / half[0])) + 0.5);
    const double nearest = camera->distance / (camera->distance - half[2]);
    camera->scale = (0.5 - MARGIN) / nearest * fmin(camera->width / half[0], camera->height / half[1]);
}

bool shv_camera_project(const ShvCamera *camera, ShvVec3 point, ShvScreenPoint *seen)
{
    const ShvVec3 arm = shv_sub(point, camera->centre);
    const double away = camera->distance - shv_dot(arm, camera->toward);
    if (!(away > 0.05 * camera->distance)) return false;
    seen->near = camera->distance / away;
    seen->x = 0.5 * camera->width + camera->scale * seen->near * shv_dot(arm, camera->right);
    seen->y = 0.5 * camera->height - camera->scale * seen->near * shv_dot(arm, camera->up);
    return true;
}
