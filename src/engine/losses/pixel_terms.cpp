#include "engine/losses/pixel_terms.h"

#include "engine/losses/pixel_rows.h"
#include "engine/losses/terms/pixel_terms.h"

namespace aligngs {
namespace {

template <class Term>
constexpr unsigned kNeedsOf = row_of(Term::kLoss).needs;

// Compiled per instruction set: function versions cannot be templates.
// NOLINTBEGIN(bugprone-macro-parentheses): Term is the name of a template, which takes no parentheses.
#define ALIGNGS_PIXEL_ROW_VERSIONS(Term)                                                                     \
  ALIGNGS_TARGET_CLONES                                                                                      \
  void row_weights(const Term<float>& term, const PixelRow<float>& row, float* weights) {                    \
    weights_of_row<kNeedsOf<Term<float>>>(term, row, weights);                                               \
  }                                                                                                          \
  void row_weights(const Term<double>& term, const PixelRow<double>& row, double* weights) {                 \
    weights_of_row<kNeedsOf<Term<double>>>(term, row, weights);                                              \
  }                                                                                                          \
  ALIGNGS_TARGET_CLONES                                                                                      \
  void row_values(const Term<float>& term, const PixelRow<float>& row, const float* weights, float step,     \
                  const PixelRowOutputs<float>& out) {                                                       \
    values_of_row<kNeedsOf<Term<float>>>(term, row, weights, step, out);                                     \
  }                                                                                                          \
  void row_values(const Term<double>& term, const PixelRow<double>& row, const double* weights, double step, \
                  const PixelRowOutputs<double>& out) {                                                      \
    values_of_row<kNeedsOf<Term<double>>>(term, row, weights, step, out);                                    \
  }
ALIGNGS_PIXEL_TERMS(ALIGNGS_PIXEL_ROW_VERSIONS)
#undef ALIGNGS_PIXEL_ROW_VERSIONS
// NOLINTEND(bugprone-macro-parentheses)

template <class Term, class T>
double loss_of(const MapLossInputs<T>& in, double weight, MapLossWorkspace<T>& workspace, MapGradients<T>& gradients) {
  const Term term(in.settings);
  return fold_pixel_term<T>(
      in, weight, kNeedsOf<Term>, [&](const PixelRow<T>& row, T* weights) { row_weights(term, row, weights); },
      [&](const PixelRow<T>& row, const T* weights, T step, const PixelRowOutputs<T>& out) {
        row_values(term, row, weights, step, out);
      },
      workspace, gradients);
}

template <class T, int kFirst, template <class> class... Terms>
PixelTermLoss<T> find(Loss loss, PixelTermList<kFirst, Terms...>) {
  PixelTermLoss<T> found = nullptr;
  ((found = Terms<T>::kLoss == loss ? &loss_of<Terms<T>, T> : found), ...);
  return found;
}

}  // namespace

template <class T>
PixelTermLoss<T> pixel_term_loss(Loss loss) {
  return find<T>(loss, PixelTerms{});
}

template PixelTermLoss<float> pixel_term_loss<float>(Loss);
template PixelTermLoss<double> pixel_term_loss<double>(Loss);

}  // namespace aligngs
