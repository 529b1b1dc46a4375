#include "train/config_keys.h"

namespace aligngs::config_table {

std::vector<ConfigKey> loss_semantic_keys() {
  using C = TrainConfig;
  using L = LossConfig;
  using S = SemanticConfig;
  return {
      {"loss.l1", field<&C::loss, &L::l1>, 0, 1e6, value(0.8), "weight of the photometric L1"},
      {"loss.ssim", field<&C::loss, &L::ssim>, 0, 1e6, value(0.2), "weight of 1 - SSIM"},
      {"loss.flatten", field<&C::loss, &L::flatten>, 0, 1e6, value(3.0),
       "weight of the mean smallest scale / extent of the visible Gaussians"},
      {"loss.pearson", field<&C::loss, &L::pearson>, 0, 1e6, value(0.5),
       "weight of L_d, 1 - Pearson(depth, prior); acts on relative prior depth, and on metric one when loss.log_depth "
       "is 0"},
      {"loss.log_depth", field<&C::loss, &L::log_depth>, 0, 1e6, value(0.5),
       "weight of L_z, Huber on log depth against metric prior depth, at the start"},
      {"loss.log_depth_end", field<&C::loss, &L::log_depth_end>, 0, 1e6, value(0.02),
       "weight of L_z at the end of the schedule; log-linear between"},
      {"loss.log_depth_huber", field<&C::loss, &L::log_depth_huber>, 1e-6, 10, value(0.02),
       "Huber delta of L_z, log units (0.02 = 2 % of depth)"},
      {"loss.depth_start", field<&C::loss, &L::depth_start>, 0, kIterationsMax, value(0),
       "[ref] depth terms act after this iteration (not before loss.normal_start when the start has no normals)"},
      {"loss.depth_align_every", field<&C::loss, &L::depth_align_every>, 0, kIterationsMax, value(500),
       "[ref] iterations between closed-form updates of the per-view scale of metric prior depth; 0 = never"},
      {"loss.depth_align_limit", field<&C::loss, &L::depth_align_limit>, 0, 0.5, value(0.03),
       "largest deviation of that scale from 1"},
      {"loss.normal_consistency", field<&C::loss, &L::normal_consistency>, 0, 1e6, value(0.015),
       "weight of L_ng, rendered normal against the normal of the rendered depth"},
      {"loss.normal_boundary", field<&C::loss, &L::normal_boundary>, 0, 1e6, value(0.0),
       "weight of the paper's L_nb at label edges"},
      {"loss.crease", field<&C::loss, &L::crease>, 0, 1e6, value(0.0),
       "weight of the one-sided normal supervision at label edges, an alternative to L_nb (0.02 was tried); needs "
       "metric prior depth"},
      {"loss.normal_start", field<&C::loss, &L::normal_start>, 0, kIterationsMax, value(500),
       "[ref] L_ng, L_nb and crease act after this iteration"},
      {"loss.prior_normal", field<&C::loss, &L::prior_normal>, 0, 1e6, value(0.05),
       "weight of the normals of metric prior depth at the start"},
      {"loss.prior_normal_end", field<&C::loss, &L::prior_normal_end>, 0, 1e6, value(0.01),
       "the same at the end of the schedule; log-linear between"},
      {"loss.plane_weight", field<&C::loss, &L::plane_weight>, 0, 16, value(0.0),
       "weight of fitted planes of walls, floor and ceiling as a target, beside prior depth of weight 1 (1 was "
       "tried); needs metric prior depth and labels; 0 = off"},
      {"loss.plane_every", field<&C::loss, &L::plane_every>, 1, kIterationsMax, value(1000),
       "[ref] iterations between these fits"},
      {"loss.multi_view_geometric", field<&C::loss, &L::multi_view_geometric>, 0, 1e6, value(0.0),
       "weight of the reprojection error (pixels) of rendered depth into a neighbouring view and back"},
      {"loss.multi_view_photometric", field<&C::loss, &L::multi_view_photometric>, 0, 1e6, value(0.0),
       "weight of 1 - NCC^2 of photo patches taken into a neighbouring view by the rendered planes"},
      {"loss.multi_view_from", field<&C::loss, &L::multi_view_from>, 0, kIterationsMax, value(1633),
       "[ref] the multi-view terms act after this iteration (published: 7000 of 30000)"},
      {"loss.multi_view_every", field<&C::loss, &L::multi_view_every>, 1, kIterationsMax, value(1),
       "they act in iterations divisible by this; 1 = every iteration"},
      {"loss.paper_normals", field<&C::loss, &L::paper_normals>, 0, 0, value(false),
       "L_ng and L_nb in the printed form, without guards at discontinuities, over pixels with a normal "
       "(docs/method.md)"},
      {"loss.opacity_l1", field<&C::loss, &L::opacity_l1>, 0, 1e6, value(0.01),
       "weight of the mean opacity (takes the place of opacity resets)"},
      {"loss.scale_l1", field<&C::loss, &L::scale_l1>, 0, 1e6, value(0.01), "weight of the mean scale / extent"},

      {"semantic.soft", field<&C::semantic, &S::soft>, 0, 1e6, value(1.0), "weight of KL(teacher || student)"},
      {"semantic.hard", field<&C::semantic, &S::hard>, 0, 1e6, value(0.1),
       "weight of the cross-entropy with the teacher's best class"},
      {"semantic.pixel_share", field<&C::semantic, &S::pixel_share>, 0.25, 1, value(0.25),
       "share of the pixels for the semantic loss of a step: 1, 0.5 or 0.25, in squares that change from visit to "
       "visit"},
      {"semantic.blend", field<&C::semantic, &S::blend>, 0, 0, value(SemanticBlend::kProbabilities),
       "what is blended along the ray"},
      {"semantic.coupling", field<&C::semantic, &S::coupling>, 0, 0, value(SemanticCoupling::kBounded),
       "path of the semantic loss to geometry: bounded surrogate, plain gradient of the printed loss, or a push "
       "on opacity without classes as a control"},
      {"semantic.coupling_strength", field<&C::semantic, &S::coupling_strength>, 0, 1e6, value(0.0),
       "share of the photometric gradient (0.1 was tried); plain: factor (0 = the release, 1 = the paper)"},
      {"semantic.coupling_start", field<&C::semantic, &S::coupling_start>, 0, kIterationsMax, value(1000),
       "[ref] semantics reach geometry after this iteration"},
      {"semantic.coupling_stop", field<&C::semantic, &S::coupling_stop>, 0, kIterationsMax, value(6300),
       "[ref] and not after this one"},
      {"semantic.lift", field<&C::semantic, &S::lift>, 0, 0, value(true),
       "closed-form start of the semantic rows from the teacher's maps"},
      {"semantic.lift_at", field<&C::semantic, &S::lift_at>, 0, kIterationsMax, value(0),
       "[ref] iteration after which the closed form is taken"},
      {"semantic.drawn_sharpness", field<&C::semantic, &S::drawn_sharpness>, 0, 16, value(4.0),
       "labels are drawn with each Gaussian's probabilities, smoothed over its neighbours, to this power; 0, or "
       "semantic.blend = "
       "\"logits\": rows as trained"},
      {"semantic.object_labels", field<&C::semantic, &S::object_labels>, 0, 0, value(true),
       "after training the photos vote for the labels of whole objects, so small objects keep their names; off, "
       "or semantic.blend = \"logits\": each Gaussian for itself"},
      {"semantic.object_votes", field<&C::semantic, &S::object_votes>, 0, 0, value(true),
       "with segments/ of every training photo, they vote for what is one object; off, or without segments: what "
       "touches is one"},
      {"semantic.active_top", field<&C::semantic, &S::active_top>, 0, 65535, value(2),
       "classes outside this many best ones of every view's teacher train as one remainder; 0 = every class alone"},
  };
}

}  // namespace aligngs::config_table
