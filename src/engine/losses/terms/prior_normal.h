// Supervision of the blended normals by the normals of the prior depth.
#pragma once

#include "engine/losses/terms/pixel_term.h"
#include "engine/settings.h"

namespace aligngs {

/// 1 - n . n_prior at pixels with a blended direction and a prior normal, weighted by the prior's confidence. A prior
/// that is not finite or not a unit vector is none.
template <class T>
struct PriorNormalTerm {
  static constexpr Loss kLoss = Loss::kPriorNormal;

  ALIGNGS_HD explicit PriorNormalTerm(const LossSettings&) {}

  ALIGNGS_HD ALIGNGS_ALWAYS_INLINE T weight(const TermPixel<T>& p) const {
    const Vec3<float>& n = p.prior_normal;
    const float square = n.x * n.x + n.y * n.y + n.z * n.z;
    const bool unit = (square > 0.9f) & (square < 1.1f), trusted = (p.confidence > 0) & (p.confidence <= 1);
    const bool used = unit & trusted & (p.inverse_length > T(0));
    return used ? static_cast<T>(p.confidence) : T(0);
  }
  ALIGNGS_HD ALIGNGS_ALWAYS_INLINE TermValue<T> at(const TermPixel<T>& p, T weight, T step) const {
    const bool used = weight > T(0);
    const T factor = used ? -step * weight * p.inverse_length : T(0);
    const T p_x = used ? static_cast<T>(p.prior_normal.x) : T(0), p_y = used ? static_cast<T>(p.prior_normal.y) : T(0),
            p_z = used ? static_cast<T>(p.prior_normal.z) : T(0);
    const Vec3<T>& n = p.direction;
    const T cosine = n.x * p_x + n.y * p_y + n.z * p_z;
    TermValue<T> out;
    out.value = weight * (T(1) - cosine);
    out.by_normal = {(p_x - n.x * cosine) * factor, (p_y - n.y * cosine) * factor, (p_z - n.z * cosine) * factor};
    return out;
  }
};

}  // namespace aligngs
