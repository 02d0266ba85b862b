/* SPDX-License-Identifier: MIT
 *
 * A C++ program that links both libraries and uses both, in two threads at once.
 */
#include <cmath>
#include <cstdio>
#include <cstring>
#include <thread>

#include <cattaneo.h>

#include "both.h"

static bool good(const char *name, const both_result &r, const size_t size) {
  std::printf("%s: %zu bytes, x = %.9f\n", name, r.size, r.x);
  return r.size == size && r.ok && r.refused && std::fabs(r.x - 1) < 1e-4;
}

int main() {
  both_result single{}, other{};
  std::thread thread([&] {
    single = run_single();
    if (std::strstr(single.sentence, "0 cells") == nullptr) single.refused = false;
  });
  other = run_double();
  thread.join();
  if (std::strstr(other.sentence, "0 cells") == nullptr) other.refused = false;
  const bool fine = good("single", single, sizeof(float)) && good("double", other, sizeof(double));
  return fine && cf_version()[0] != '\0' ? 0 : 1;
}
