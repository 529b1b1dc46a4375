// Chooses the implementation of a product: a library for the device if there is one and it takes the shape, otherwise
// the kernels of products.h.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "nn/cuda/products.h"

namespace aligngs::cuda {

/// Products by a library, of the same operands and with the same formulas as multiply_bf16 and multiply_float.
class LibraryProducts {
 public:
  virtual ~LibraryProducts() = default;
  virtual std::string name() const = 0;
  /// False, with y as it was, when the library has no way to form this product. Error when the device fails.
  virtual bool multiply(const ProductSpans& product, DeviceSpan<const uint16_t> x, DeviceSpan<const uint16_t> w) = 0;
  virtual bool multiply(const ProductSpans& product, DeviceSpan<const float> x, DeviceSpan<const float> w) = 0;
};

struct LibraryStart {
  std::unique_ptr<LibraryProducts> products;  ///< null: the program's own kernels form all products
  std::string reason;                         ///< why it is null; empty where nobody would expect a library
};

/// Says in the log, once each, that there is no library and that the library refused a product.
class MatrixProducts {
 public:
  MatrixProducts(const DeviceContext& context, LibraryStart start);

  void multiply(const ProductSpans& product, DeviceSpan<const uint16_t> x, DeviceSpan<const uint16_t> w);
  void multiply(const ProductSpans& product, DeviceSpan<const float> x, DeviceSpan<const float> w);

 private:
  template <class T>
  bool taken(const ProductSpans& product, DeviceSpan<const T> x, DeviceSpan<const T> w);

  const DeviceContext& context_;
  std::unique_ptr<LibraryProducts> library_;
  std::atomic<bool> refusal_said_{false};
};

}  // namespace aligngs::cuda
