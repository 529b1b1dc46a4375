#include "engine/shared/optimiser_settings.h"

#include "core/error.h"

namespace aligngs {

namespace {

void check(const char* name, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw_usage(std::string(name) + " is " + std::to_string(value) + ", outside [" + std::to_string(low) + ", " +
                  std::to_string(high) + "]",
              "correct the optimiser's settings");
}

}  // namespace

void check_optimiser_settings(const StepRequest& request) {
  const LearningRates& r = request.rates;
  check("the rate of positions", r.position, 0, 1e4);
  check("the rate of colours", r.sh_dc, 0, 1e4);
  check("the rate of view-dependent colours", r.sh_rest, 0, 1e4);
  check("the rate of opacities", r.opacity, 0, 1e4);
  check("the rate of scales", r.scale, 0, 1e4);
  check("the rate of rotations", r.rotation, 0, 1e4);
  check("the rate of semantics", r.semantic, 0, 1e4);
  check("Adam's beta1", request.adam.beta1, 0, 0.999999);
  check("Adam's beta2", request.adam.beta2, 0, 0.999999);
  check("Adam's epsilon", request.adam.epsilon, 1e-20, 1);
}

}  // namespace aligngs
