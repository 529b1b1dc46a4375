// The scalar reference: rendering (reference_forward.h) and gradients (reference_gradients.h), templated so that tests
// run them in double. It specifies what every Engine computes; it is not for use on real scenes.
#pragma once

#include "engine/reference/reference_forward.h"
#include "engine/reference/reference_gradients.h"
