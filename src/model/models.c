/* SPDX-License-Identifier: MIT
 *
 * The models that a scene can name, in the order of CF_MODEL_WORDS.
 */
#include "model/model.h"

static const cf_model *const models[] = {&cf_model_tracer};

const cf_model *cf_model_of(const int word) {
  return word >= 0 && word < (int)(sizeof models / sizeof *models) ? models[word] : NULL;
}
