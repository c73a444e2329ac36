/* What of obstacles goes to a checkpoint: how they stand and move. */
#ifndef SHV_SHAPE_OBSTACLE_ARCHIVE_H
#define SHV_SHAPE_OBSTACLE_ARCHIVE_H

#include "base/archive.h"
#include "shape/obstacle.h"

bool shv_obstacles_archive(ShvObstacles *obstacles, ShvArchive *archive);

#endif
