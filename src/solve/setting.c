/* SPDX-License-Identifier: MIT */
#include "solve/setting.h"

#include "base/real.h"

enum { SETTINGS_2D = 4, SETTINGS_3D = 6 };
static const cf_setting in_2d[SETTINGS_2D] = {
    {0, {1.968, 0.114, -0.044, 0, 0.663, -0.005, 0.095, -0.326}, 0, -0.012},
    {0.0154, {2.146, 0.065, -0.032, 0, 0.552, -0.011, 0.106, -0.301}, 0.018, -0.020},
    {0.0476, {1.464, 0.240, -0.024, 0, 0.356, 0.016, 0.168, -0.143}, 0.052, -0.057},
    {0.0943, {1.515, 0.269, 0.005, 0, 0.233, 0.026, 0.182, -0.118}, 0.090, -0.125},
};
static const cf_setting in_3d[SETTINGS_3D] = {
    {0, {0.729, 0.307, 0.047, 0, 1.330, -0.095, 0.167, -0.118}, 0, 0},
    {0.0103, {0.691, 0.223, 0.055, 0, 1.101, -0.114, 0.095, -0.157}, 0.017, -0.019},
    {0.0204, {0.766, 0.187, 0.029, 0, 0.823, -0.037, 0.154, -0.136}, 0.034, -0.037},
    {0.0400, {0.808, 0.219, 0.032, 0, 0.591, -0.012, 0.193, -0.176}, 0.054, -0.077},
    {0.0676, {0.821, 0.164, 0.034, 0, 0.451, -0.014, 0.193, -0.114}, 0.080, -0.140},
    {0.0943, {0.637, 0.227, 0.081, 0, 0.245, -0.005, 0.180, -0.088}, 0.090, -0.266},
};

/* Linear between the rows. */
cf_setting cf_setting_for(const int dim, const double stiffness) {
  const cf_setting *row = dim == 3 ? in_3d : in_2d;
  const cf_setting *last = row + (dim == 3 ? SETTINGS_3D : SETTINGS_2D) - 2;
  cf_setting s = {.share = 1 / (1 + stiffness)};
  while (row < last && s.share > row[1].share) ++row;
  const double way = CF_MIN((s.share - row[0].share) / (row[1].share - row[0].share), 1);
  s.alpha = row[0].alpha + way * (row[1].alpha - row[0].alpha);
  s.beta = row[0].beta + way * (row[1].beta - row[0].beta);
  for (int v = 0; v < CF_BOX_HALF_SWEEPS; ++v)
    s.over[v] = row[0].over[v] + way * (row[1].over[v] - row[0].over[v]);
  return s;
}
