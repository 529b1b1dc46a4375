// Semantic distillation at one pixel: values, gradient of the Gaussians' rows, and the gradient that reaches the
// blending weights (coupling). As AlignGS (Gao et al. 2025) prints it, and ours.
//
// Everything an engine needs per pixel is two vectors of length C:
//   row gradient g: dL/dx_k = w_k g, with x_k what is blended (kLogits: s_k; kProbabilities: pi_k = softmax(s_k));
//   coupling h and a number h_0: dL_geo/dw_k = h . x_k - h_0, which AlphaSweep of blending.h takes as q_k, with
//   nothing behind the last Gaussian (total = sum_k w_k q_k).
// Over a tile these are the matrix products dX = W^T G and Q = H X^T.
#pragma once

#include <cmath>

#include "core/host_device.h"

namespace aligngs {

/// Floor of Q_c inside the logarithm, lowered for very many classes so that the uniform start,
/// 1 / C, always lies above it and has a gradient.
template <class T>
ALIGNGS_HD inline T semantic_floor(int channels) {
  const T half_uniform = T(0.5) / T(channels);
  return half_uniform < T(1e-3) ? half_uniform : T(1e-3);
}

/// Pixels with less coverage take no part in the bounded coupling: dividing by A is then no longer bounded. Everywhere
/// in this program "nothing here" is alpha < 0.5.
inline constexpr double kCouplingAlphaMin = 0.5;

/// Unweighted values at one pixel.
template <class T>
struct SemanticTerms {
  T soft{};  ///< KL(teacher || student), nats, >= 0 up to the floor
  T hard{};  ///< cross-entropy with the teacher's arg-max, nats
};

/// Weights of the two terms, each already divided by the number of valid pixels.
template <class T>
struct SemanticWeights {
  T soft{}, hard{};
};

/// Class of the largest probability; the lowest index wins ties.
template <class T>
ALIGNGS_HD inline int arg_max(const T* p, int channels) {
  int best = 0;
  for (int c = 1; c < channels; ++c) {
    if (p[c] > p[best]) best = c;
  }
  return best;
}

/// pi = softmax(s), with the maximum subtracted. `out` may be `s`.
template <class T>
ALIGNGS_HD inline void softmax(const T* s, int channels, T* out) {
  using std::exp;
  T top = s[0];
  for (int c = 1; c < channels; ++c) top = s[c] > top ? s[c] : top;
  T sum = T(0);
  for (int c = 0; c < channels; ++c) {
    out[c] = exp(s[c] - top);
    sum += out[c];
  }
  const T inverse = T(1) / sum;
  for (int c = 0; c < channels; ++c) out[c] *= inverse;
}

/// Row gradient through pi = softmax(s): ds = pi * (g - pi . g). `ds` may be `g`.
template <class T>
ALIGNGS_HD inline void softmax_backward(const T* pi, const T* g, int channels, T* ds) {
  T along = T(0);
  for (int c = 0; c < channels; ++c) along += pi[c] * g[c];
  for (int c = 0; c < channels; ++c) ds[c] = pi[c] * (g[c] - along);
}

/// Sum p log p, the constant that makes the soft term a KL divergence.
template <class T>
ALIGNGS_HD inline T negative_entropy(const T* p, int channels) {
  using std::log;
  T sum = T(0);
  for (int c = 0; c < channels; ++c) {
    if (p[c] > T(0)) sum += p[c] * log(p[c]);
  }
  return sum;
}

/// kLogits, the paper: `logits` P = sum_k w_k s_k (nothing behind: 0, a uniform student), q = softmax(P),
/// y = arg-max p.
///   L = soft KL(p || q) - hard log q_y,   g = dP = soft (q - p) + hard (q - onehot_y).
/// `gradient` receives dP; it may be `logits`. `student` receives q.
template <class T>
ALIGNGS_HD inline SemanticTerms<T> semantic_loss_logits(const T* logits, const T* teacher, int channels,
                                                        const SemanticWeights<T>& weights, T* student, T* gradient) {
  using std::exp;
  using std::log;
  const int y = arg_max(teacher, channels);
  T top = logits[0];
  for (int c = 1; c < channels; ++c) top = logits[c] > top ? logits[c] : top;
  T sum = T(0), mass = T(0), cross = T(0);
  const T logit_y = logits[y];
  for (int c = 0; c < channels; ++c) {
    student[c] = exp(logits[c] - top);
    sum += student[c];
    mass += teacher[c];
    cross += teacher[c] * (logits[c] - top);
  }
  const T log_sum = log(sum), inverse = T(1) / sum;
  SemanticTerms<T> terms;
  terms.soft = negative_entropy(teacher, channels) - cross + mass * log_sum;
  terms.hard = top + log_sum - logit_y;
  for (int c = 0; c < channels; ++c) {
    student[c] *= inverse;
    gradient[c] = weights.soft * (mass * student[c] - teacher[c]) + weights.hard * student[c];
  }
  gradient[y] -= weights.hard;
  return terms;
}

/// kProbabilities, our default: `blended` B = sum_k w_k pi_k, A = sum_k w_k, Q = B + (1 - A) / C. With f the floor:
///   L = soft [sum p log p - sum_c p_c log max(Q_c, f)] - hard log max(Q_y, f),
///   g_c = -(soft p_c + hard [c = y]) / Q_c where Q_c > f, else 0.
/// The remainder (1 - A) / C gives the rows no gradient. `gradient` receives g and may be `blended`.
template <class T>
ALIGNGS_HD inline SemanticTerms<T> semantic_loss_probabilities(const T* blended, T alpha, const T* teacher,
                                                               int channels, const SemanticWeights<T>& weights,
                                                               T* gradient) {
  using std::log;
  const int y = arg_max(teacher, channels);
  const T floor = semantic_floor<T>(channels), remainder = (T(1) - alpha) / T(channels);
  SemanticTerms<T> terms;
  terms.soft = negative_entropy(teacher, channels);
  for (int c = 0; c < channels; ++c) {
    const T q = blended[c] + remainder;
    const bool above = q > floor;
    const T log_q = log(above ? q : floor);
    terms.soft -= teacher[c] * log_q;
    if (c == y) terms.hard = -log_q;
    gradient[c] = above ? -(weights.soft * teacher[c] + (c == y ? weights.hard : T(0))) / q : T(0);
  }
  return terms;
}

// ---- coupling: what the blending weights, hence opacity, mean and covariance, receive ----
// kOpacity needs no formula: L_geo = -omega A, so h = 0 and h_0 = omega.

/// kPlain: the gradient of the loss as printed. kLogits: h = dP, h_0 = 0. kProbabilities: dQ/dw_k = pi_k - 1/C, so
/// h = g and h_0 = sum_c g_c / C. Returns h_0; h is the row gradient itself.
template <class T>
ALIGNGS_HD inline T plain_coupling_offset(bool probabilities, const T* row_gradient, int channels) {
  if (!probabilities) return T(0);
  T sum = T(0);
  for (int c = 0; c < channels; ++c) sum += row_gradient[c];
  return sum / T(channels);
}

/// kBounded with kProbabilities: L_geo = 1/2 omega |B / A - t|^2 with A detached, so
/// h = omega (B / A - t) / A and h_0 = 0. Zero where A < 0.5. `omega` is the pixel's weight divided by the number of
/// valid pixels. Returns L_geo; `h` must not be `blended`.
template <class T>
ALIGNGS_HD inline T bounded_coupling_probabilities(const T* blended, T alpha, const T* teacher, int channels, T omega,
                                                   T* h) {
  if (alpha < T(kCouplingAlphaMin)) {
    for (int c = 0; c < channels; ++c) h[c] = T(0);
    return T(0);
  }
  const T inverse = T(1) / alpha;
  T square = T(0);
  for (int c = 0; c < channels; ++c) {
    const T difference = blended[c] * inverse - teacher[c];
    square += difference * difference;
    h[c] = omega * difference * inverse;
  }
  return T(0.5) * omega * square;
}

/// kBounded with kLogits: the same squared error of q = softmax(P): L_geo = 1/2 omega |q - t|^2,
/// h = dP = omega q * (e - q . e) with e = q - t. No division by A: P as printed. Zero where A < 0.5. Returns L_geo.
template <class T>
ALIGNGS_HD inline T bounded_coupling_logits(const T* student, T alpha, const T* teacher, int channels, T omega, T* h) {
  T square = T(0), along = T(0);
  for (int c = 0; c < channels; ++c) {
    const T e = student[c] - teacher[c];
    square += e * e;
    along += student[c] * e;
  }
  if (alpha < T(kCouplingAlphaMin)) square = T(0), omega = T(0);
  for (int c = 0; c < channels; ++c) h[c] = omega * student[c] * (student[c] - teacher[c] - along);
  return T(0.5) * omega * square;
}

/// The running values from which an engine takes the factor of the bounded coupling.
struct CouplingBalance {
  double photometric = 0;  ///< running RMS over visible Gaussians of dL_photometric / d mean2D, pixels^-1
  double semantic = 0;     ///< the same of L_geo, before the factor
};

/// Weight of the past in CouplingBalance: about ten steps, so that one odd view does not set the strength.
inline constexpr double kCouplingMemory = 0.9;

/// Takes in one step's RMS values (sqrt of the mean of |gradient|^2 over visible Gaussians, in pixel units).
/// A step without a semantic gradient leaves the balance as it is; the first one sets it.
ALIGNGS_HD inline void update_coupling_balance(double photometric_rms, double semantic_rms, CouplingBalance& balance) {
  if (!(semantic_rms > 0) || !(photometric_rms - photometric_rms == 0) || !(semantic_rms - semantic_rms == 0)) return;
  const double keep = balance.semantic > 0 ? kCouplingMemory : 0.0;
  balance.photometric = keep * balance.photometric + (1 - keep) * photometric_rms;
  balance.semantic = keep * balance.semantic + (1 - keep) * semantic_rms;
}

/// strength * photometric / semantic; 0 before the first step with a semantic gradient, so coupling begins one step
/// after the loss does.
ALIGNGS_HD inline double coupling_factor(double strength, const CouplingBalance& balance) {
  return balance.semantic > 0 ? strength * (balance.photometric / balance.semantic) : 0.0;
}

}  // namespace aligngs
