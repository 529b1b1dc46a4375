#include "train/config_keys.h"

namespace aligngs::config_table {

std::vector<ConfigKey> densify_optimizer_keys() {
  using C = TrainConfig;
  using D = DensifyConfig;
  using O = OptimizerConfig;
  return {
      {"densify.enabled", field<&C::densify, &D::enabled>, 0, 0, value(true), "adaptive density control"},
      {"densify.strategy", field<&C::densify, &D::strategy>, 0, 0, value(GrowthStrategy::kAdaptive),
       "growth: clone, split and prune (3DGS), or move dead Gaussians to living ones (3DGS-MCMC; set "
       "densify.max_gaussians, loss.opacity_l1 and loss.scale_l1 with it)"},
      {"densify.growth", field<&C::densify, &D::growth>, 1, 10, value(1.05),
       "mcmc: number of Gaussians after a call / before, until the cap"},
      {"densify.noise", field<&C::densify, &D::noise>, 0, 1e9, value(5e5),
       "mcmc: strength of the noise on the places of nearly transparent Gaussians / learning rate of positions"},
      {"densify.start", field<&C::densify, &D::start>, 0, kIterationsMax, value(350),
       "[ref] density control acts after this iteration"},
      {"densify.stop", field<&C::densify, &D::stop>, 0, kIterationsMax, value(3500), "[ref] and not after this one"},
      {"densify.every", field<&C::densify, &D::every>, 1, kIterationsMax, value(100),
       "[ref] iterations between two calls"},
      {"densify.min_epochs", field<&C::densify, &D::min_epochs>, 0, 1000, value(2.0),
       "at least so many visits of every view between two calls (the paper's 100 iterations are 3 to 5)"},
      {"densify.gradient", field<&C::densify, &D::gradient>, 0, kAny, value(2e-4),
       "mean gradient of the 2-D position (normalised device coordinates) above which a Gaussian grows"},
      {"densify.gradient_abs", field<&C::densify, &D::gradient_abs>, 0, kAny, value(8e-4),
       "mean absolute gradient above which a large Gaussian splits; 0 = off"},
      {"densify.small_scale", field<&C::densify, &D::small_scale>, 0, kAny, value(0.001),
       "largest scale / extent up to which growing means cloning, not splitting"},
      {"densify.prune_opacity", field<&C::densify, &D::prune_opacity>, 0, 1, value(0.005),
       "Gaussians below this opacity are removed"},
      {"densify.prune_scale", field<&C::densify, &D::prune_scale>, 0, kAny, value(0.0),
       "Gaussians with a largest scale / extent above this are removed; 0 = never"},
      {"densify.prune_scale_start", field<&C::densify, &D::prune_scale_start>, 0, kIterationsMax, value(3000),
       "[ref] the scale rule acts after this iteration"},
      {"densify.max_growth", field<&C::densify, &D::max_growth>, 0, 1e6, value(2.5),
       "cap on the number of Gaussians / number at a start from prior depth (other starts: / the limit on starts); 0 = "
       "none"},
      {"densify.max_gaussians", field<&C::densify, &D::max_gaussians>, 0, 1e8, value(0),
       "cap on the number of Gaussians; 0: from max_growth, or (paper) 6000000 and half the training pixels, "
       "fewer in short runs; memory may lower it"},
      {"densify.morton_order", field<&C::densify, &D::morton_order>, 0, 0, value(true),
       "sort the Gaussians along a Morton curve at the start and at each call, for speed; later rows get other "
       "random numbers"},
      {"densify.residual_quantile", field<&C::densify, &D::residual_quantile>, 0, 1, value(0.0),
       "after a start from prior depth, grow only above this quantile of the photometric residual; 0 = everywhere"},
      {"densify.unsupported_min", field<&C::densify, &D::unsupported_min>, 0, 1, value(0.0),
       "after a start from prior depth, grow only where this share of the weight lacks agreeing prior depth; 0 = "
       "everywhere"},
      {"densify.opacity_reset_every", field<&C::densify, &D::opacity_reset_every>, 0, kIterationsMax, value(0),
       "[ref] iterations between opacity resets to 0.01 while density control acts, but none in the last steps, in "
       "which opacity "
       "would not recover (272 at the usual rate); 0 = never"},
      {"densify.free_space_every", field<&C::densify, &D::free_space_every>, 0, kIterationsMax, value(500),
       "[ref] iterations between removals of Gaussians that float in free space; 0 = never"},
      {"densify.free_space_prior", field<&C::densify, &D::free_space_prior>, 0, 1, value(0.04),
       "free space: relative distance in front of metric prior depth"},
      {"densify.free_space_offset", field<&C::densify, &D::free_space_offset>, 0, 1, value(0.008),
       "free space: distance / extent added to it (about 2 cm in a room)"},
      {"densify.free_space_rendered", field<&C::densify, &D::free_space_rendered>, 0, 1, value(0.05),
       "free space: relative distance in front of the rendered median depth"},
      {"densify.free_space_agreement", field<&C::densify, &D::free_space_agreement>, 0, 1, value(0.03),
       "free space: a view supports a Gaussian within this relative distance of its rendered depth"},

      {"optimizer.position", field<&C::optimizer, &O::position>, 0, 1, value(1.6e-4),
       "learning rate of positions / extent at the start"},
      {"optimizer.position_end", field<&C::optimizer, &O::position_end>, 0, 1, value(1.6e-6),
       "the same at the end of the schedule; log-linear between"},
      {"optimizer.sh_dc", field<&C::optimizer, &O::sh_dc>, 0, 10, value(2.5e-3), "learning rate of the base colour"},
      {"optimizer.sh_rest", field<&C::optimizer, &O::sh_rest>, 0, 10, value(1.25e-4),
       "learning rate of the view-dependent colour"},
      {"optimizer.opacity", field<&C::optimizer, &O::opacity>, 0, 10, value(0.05), "learning rate of opacity logits"},
      {"optimizer.scale", field<&C::optimizer, &O::scale>, 0, 10, value(5e-3), "learning rate of log scales"},
      {"optimizer.rotation", field<&C::optimizer, &O::rotation>, 0, 10, value(3e-4), "learning rate of quaternions"},
      {"optimizer.semantic", field<&C::optimizer, &O::semantic>, 0, 10, value(4e-2), "learning rate of semantic rows"},
      {"optimizer.skip_invisible_semantics", field<&C::optimizer, &O::skip_invisible_semantics>, 0, 0, value(true),
       "semantic rows that no pixel used keep their values and moments"},
      {"optimizer.flat_ratio_max", field<&C::optimizer, &O::flat_ratio_max>, 0, 1, value(0.2),
       "hard limit on smallest / middle scale; 0 = off"},
      {"optimizer.aspect_max", field<&C::optimizer, &O::aspect_max>, 0, 1e6, value(6.0),
       "hard limit on largest / middle scale; 0 = off"},
      {"optimizer.scale_min_pixels", field<&C::optimizer, &O::scale_min_pixels>, 0, 100, value(0.7),
       "lower limit on the two larger scales, in pixels of the sharpest training view; applied every hundredth of "
       "7000 iterations; 0 = off"},
      {"optimizer.pose_rotation", field<&C::optimizer, &O::pose_rotation>, 0, 1, value(0.0),
       "learning rate of the training cameras' rotations, radians; the first camera stays fixed"},
      {"optimizer.pose_translation", field<&C::optimizer, &O::pose_translation>, 0, 1, value(0.0),
       "learning rate of their places / extent; both 0 = cameras stay as they are"},
      {"optimizer.pose_end", field<&C::optimizer, &O::pose_end>, 1e-6, 1, value(0.03),
       "share of both rates that is left at optimizer.pose_stop; log-linear between"},
      {"optimizer.pose_decay", field<&C::optimizer, &O::pose_decay>, 0, 1, value(0.01),
       "share of its move that a camera gives back at each of its steps"},
      {"optimizer.pose_start", field<&C::optimizer, &O::pose_start>, 0, kIterationsMax, value(700),
       "[ref] cameras move after this iteration"},
      {"optimizer.pose_stop", field<&C::optimizer, &O::pose_stop>, 0, kIterationsMax, value(5600),
       "[ref] and not after this one"},
      {"optimizer.scale_max", field<&C::optimizer, &O::scale_max>, 0, 1e6, value(0.0),
       "hard limit on the largest scale / extent; 0 = off"},
  };
}

}  // namespace aligngs::config_table
