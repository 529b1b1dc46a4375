#include "train/view_order.h"

#include <numeric>

#include "core/error.h"

namespace aligngs {

ViewOrder::ViewOrder(int views, uint64_t seed) : views_(views), random_(seed) {
  if (views < 1) throw_bad_input({}, "train", "there is no training view", "list training views in split.json");
}

int ViewOrder::next() {
  if (left_.empty()) {
    left_.resize(static_cast<size_t>(views_));
    std::iota(left_.begin(), left_.end(), 0);
    random_.shuffle(left_);
  }
  const int view = left_.back();
  left_.pop_back();
  return view;
}

void ViewOrder::set_state(const State& state) {
  for (const int view : state.left) {
    if (view < 0 || view >= views_) throw_bad_input({}, "order", "the checkpoint names a view that does not exist");
  }
  left_ = state.left;
  random_.set_state(state.random);
}

}  // namespace aligngs
