#include "train/config_keys.h"

namespace aligngs::config_table {

std::vector<ConfigKey> densify_optimizer_keys() {
  using C = TrainConfig;
  using D = DensifyConfig;
  using O = OptimizerConfig;
  return {
      {"densify.enabled", field<&C::densify, &D::enabled>, 0, 0, "", all(true), "adaptive density control"},
      {"densify.start", field<&C::densify, &D::start>, 0, kIterationsMax, "", ours_paper(350, 500),
       "[ref] density control acts after this iteration"},
      {"densify.stop", field<&C::densify, &D::stop>, 0, kIterationsMax, "", ours_paper(3500, 7000),
       "[ref] and not after this one"},
      {"densify.every", field<&C::densify, &D::every>, 1, kIterationsMax, "", all(100),
       "[ref] iterations between two calls"},
      {"densify.min_epochs", field<&C::densify, &D::min_epochs>, 0, 1000, "", ours_paper(2.0, 1.0),
       "at least so many visits of every view between two calls (the paper's 100 iterations are 3 to 5)"},
      {"densify.gradient", field<&C::densify, &D::gradient>, 0, kAny, "", all(2e-4),
       "mean gradient of the 2-D position (normalised device coordinates) above which a Gaussian grows"},
      {"densify.gradient_abs", field<&C::densify, &D::gradient_abs>, 0, kAny, "", ours_paper(0.0, 8e-4),
       "mean absolute gradient above which a large Gaussian splits; 0 = off"},
      {"densify.small_scale", field<&C::densify, &D::small_scale>, 0, kAny, "", ours_paper(0.01, 0.001),
       "largest scale / extent up to which growing means cloning, not splitting"},
      {"densify.prune_opacity", field<&C::densify, &D::prune_opacity>, 0, 1, "", all(0.005),
       "Gaussians below this opacity are removed"},
      {"densify.prune_scale", field<&C::densify, &D::prune_scale>, 0, kAny, "", ours_paper(0.0, 0.1),
       "Gaussians with a largest scale / extent above this are removed; 0 = never"},
      {"densify.prune_scale_start", field<&C::densify, &D::prune_scale_start>, 0, kIterationsMax, "", all(3000),
       "[ref] the scale rule acts after this iteration"},
      {"densify.max_growth", field<&C::densify, &D::max_growth>, 0, 1e6, "", ours_paper(1.5, 0.0),
       "cap on the number of Gaussians / number at a start from prior depth (other starts: / the limit on starts); 0 = none"},
      {"densify.max_gaussians", field<&C::densify, &D::max_gaussians>, 0, 1e8, "", all(0),
       "cap on the number of Gaussians; 0: from max_growth, or (paper) 6000000 and half the training pixels, less in a "
       "run shorter than the reference; lowered to what memory holds"},
      {"densify.morton_order", field<&C::densify, &D::morton_order>, 0, 0, "", all(true),
       "the start and each call put the Gaussians in the order of a Morton curve through space, for speed; rows that grow "
       "later then meet other random numbers"},
      {"densify.residual_quantile", field<&C::densify, &D::residual_quantile>, 0, 1, "", ours_paper(0.9, 0.0),
       "after a start from prior depth, grow only above this quantile of the photometric residual; 0 = everywhere"},
      {"densify.unsupported_min", field<&C::densify, &D::unsupported_min>, 0, 1, "", ours_paper(0.5, 0.0),
       "after a start from prior depth, grow only where this share of the weight lacks agreeing prior depth; 0 = everywhere"},
      {"densify.opacity_reset_every", field<&C::densify, &D::opacity_reset_every>, 0, kIterationsMax, "",
       ours_paper(0, 3000), "[ref] iterations between opacity resets to 0.01 while density control acts; 0 = never"},
      {"densify.free_space_every", field<&C::densify, &D::free_space_every>, 0, kIterationsMax, "", ours_paper(500, 0),
       "[ref] iterations between removals of Gaussians that float in free space; 0 = never"},
      {"densify.free_space_prior", field<&C::densify, &D::free_space_prior>, 0, 1, "", all(0.04),
       "free space: relative distance in front of metric prior depth"},
      {"densify.free_space_offset", field<&C::densify, &D::free_space_offset>, 0, 1, "", all(0.008),
       "free space: distance / extent added to it (about 2 cm in a room)"},
      {"densify.free_space_rendered", field<&C::densify, &D::free_space_rendered>, 0, 1, "", all(0.05),
       "free space: relative distance in front of the rendered median depth"},
      {"densify.free_space_agreement", field<&C::densify, &D::free_space_agreement>, 0, 1, "", all(0.03),
       "free space: a view supports a Gaussian within this relative distance of its rendered depth"},

      {"optimizer.position", field<&C::optimizer, &O::position>, 0, 1, "", all(1.6e-4),
       "learning rate of positions / extent at the start"},
      {"optimizer.position_end", field<&C::optimizer, &O::position_end>, 0, 1, "", all(1.6e-6),
       "the same at the end of the schedule; log-linear between"},
      {"optimizer.sh_dc", field<&C::optimizer, &O::sh_dc>, 0, 10, "", all(2.5e-3), "learning rate of the base colour"},
      {"optimizer.sh_rest", field<&C::optimizer, &O::sh_rest>, 0, 10, "", all(1.25e-4),
       "learning rate of the view-dependent colour"},
      {"optimizer.opacity", field<&C::optimizer, &O::opacity>, 0, 10, "", all(0.05), "learning rate of opacity logits"},
      {"optimizer.scale", field<&C::optimizer, &O::scale>, 0, 10, "", all(5e-3), "learning rate of log scales"},
      {"optimizer.rotation", field<&C::optimizer, &O::rotation>, 0, 10, "", all(1e-3), "learning rate of quaternions"},
      {"optimizer.semantic", field<&C::optimizer, &O::semantic>, 0, 10, "", ours_paper(4e-2, 1e-3),
       "learning rate of semantic rows"},
      {"optimizer.skip_invisible_semantics", field<&C::optimizer, &O::skip_invisible_semantics>, 0, 0, "",
       ours_paper(true, false), "semantic rows that no pixel used keep their values and moments"},
      {"optimizer.flat_ratio_max", field<&C::optimizer, &O::flat_ratio_max>, 0, 1, "", ours_paper(0.2, 0.0),
       "hard limit on smallest / middle scale; 0 = off"},
      {"optimizer.aspect_max", field<&C::optimizer, &O::aspect_max>, 0, 1e6, "", ours_paper(6.0, 0.0),
       "hard limit on largest / middle scale; 0 = off"},
      {"optimizer.scale_max", field<&C::optimizer, &O::scale_max>, 0, 1e6, "", all(0.0),
       "hard limit on the largest scale / extent; 0 = off"},
  };
}

}  // namespace aligngs::config_table
