/* SPDX-License-Identifier: MIT
 *
 * The header and nothing else, so that it must bring all it needs. Each function of the list is one that is
 * declared.
 */
#include <cattaneo.h>

int main(void) {
#define TAKE(name) (void)&cf_##name;
  CF_PUBLIC_LIST(TAKE)
  return 0;
}
