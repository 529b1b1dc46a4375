#include "nn/cuda/matrix_products.h"

#include <utility>

#include "core/log.h"

namespace aligngs::cuda {

MatrixProducts::MatrixProducts(const DeviceContext& context, LibraryStart start)
    : context_(context), library_(std::move(start.products)) {
  if (library_ != nullptr) {
    log_debug("products of networks by {}", library_->name());
  } else if (!start.reason.empty()) {
    log_info("products of networks by the program's own kernels: {}", start.reason);
  }
}

template <class T>
bool MatrixProducts::taken(const ProductSpans& product, DeviceSpan<const T> x, DeviceSpan<const T> w) {
  if (library_ == nullptr) return false;
  if (library_->multiply(product, x, w)) return true;
  if (!refusal_said_.exchange(true)) {
    log_info("some products of networks by the program's own kernels: {} takes no product of {} x {} with {} x {}",
             library_->name(), product.rows, product.depth, product.depth, product.outputs);
  }
  return false;
}

void MatrixProducts::multiply(const ProductSpans& product, DeviceSpan<const uint16_t> x, DeviceSpan<const uint16_t> w) {
  if (!taken(product, x, w)) multiply_bf16(context_, product, x, w);
}

void MatrixProducts::multiply(const ProductSpans& product, DeviceSpan<const float> x, DeviceSpan<const float> w) {
  if (!taken(product, x, w)) multiply_float(context_, product, x, w);
}

}  // namespace aligngs::cuda
