// Products by cuBLASLt.
#pragma once

#include "engine/cuda/networks/device_pool.h"
#include "engine/cuda/networks/matrix_products.h"

namespace aligngs::cuda {

class CublasLt;

/// By a library that was started. The pool gives the scratch memory and must outlive the products.
std::unique_ptr<LibraryProducts> make_lt_products(DevicePool& pool, std::shared_ptr<CublasLt> lt);

/// Loads and starts the library for the pool's device. No library, with the reason, where cuBLASLt is not
/// installed or not of the version of the headers; without a reason under emulation, which never has one.
LibraryStart start_lt_products(DevicePool& pool);

}  // namespace aligngs::cuda
