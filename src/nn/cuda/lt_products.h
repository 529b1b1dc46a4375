// Products by cuBLASLt.
#pragma once

#include "nn/cuda/device_pool.h"
#include "nn/cuda/matrix_products.h"

namespace aligngs::cuda {

class CublasLt;

/// By a library that was started. The pool gives the scratch memory and must outlive the products.
std::unique_ptr<LibraryProducts> make_lt_products(DevicePool& pool, std::shared_ptr<CublasLt> lt);

/// Loads and starts the library for the pool's device. Returns no library, with the reason, if cuBLASLt is not
/// installed or differs from the version of the headers. The emulation never has one, and gives no reason.
LibraryStart start_lt_products(DevicePool& pool);

}  // namespace aligngs::cuda
