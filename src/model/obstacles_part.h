/* SPDX-License-Identifier: MIT */
#ifndef CF_MODEL_OBSTACLES_PART_H
#define CF_MODEL_OBSTACLES_PART_H

#include "model/obstacles.h"

/* Obstacle i of the scene; its samples are freed by cf_obstacles_destroy. */
cf_status cf_obstacle_make(cf_obstacles *all, int i);

#endif
