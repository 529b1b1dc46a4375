#include "nn/cuda/lt_products.h"

#include <utility>

#include "nn/cuda/cublas_lt.h"

#ifdef ALIGNGS_CUBLAS_LT

#include <map>
#include <mutex>
#include <tuple>
#include <type_traits>

#include "nn/cuda/lt_layout.h"
#include "nn/cuda/row_operators.h"

namespace aligngs::cuda {
namespace {

// Partial sums of products that are split along their depth. NVIDIA recommends this size for its largest devices
// (cuBLAS documentation, cublasSetWorkspace: 32 MiB on Hopper and Blackwell, 4 MiB elsewhere). An algorithm takes the
// part that it needs.
constexpr uint64_t kMostWorkspaceBytes = uint64_t(32) << 20;

template <class Pointer>
using LtOwner = std::unique_ptr<std::remove_pointer_t<Pointer>, cublasStatus_t (*)(Pointer)>;

/// The key by which an algorithm is chosen. It has alignments, because the library's fast loads need some.
struct LtShape {
  bool halves = false;
  int64_t rows = 0, outputs = 0, depth = 0;
  LtEpilogue epilogue;
  uint32_t x_alignment = 0, w_alignment = 0, y_alignment = 0, bias_alignment = 0;

  bool operator<(const LtShape& o) const {
    const auto all = [](const LtShape& s) {
      return std::make_tuple(s.halves, s.rows, s.outputs, s.depth, s.epilogue.bias, s.epilogue.relu, s.x_alignment,
                             s.w_alignment, s.y_alignment, s.bias_alignment);
    };
    return all(*this) < all(o);
  }
};

/// A product as the library wants to be told, and the algorithm that it chose.
struct LtPlan {
  LtOwner<cublasLtMatmulDesc_t> operation;
  LtOwner<cublasLtMatrixLayout_t> left, right, result;
  cublasLtMatmulHeuristicResult_t choice{};
  bool possible = false;
};

class LtProducts : public LibraryProducts {
 public:
  LtProducts(DevicePool& pool, std::shared_ptr<CublasLt> lt) : pool_(pool), lt_(std::move(lt)) {}

  std::string name() const override { return lt_->name(); }
  bool multiply(const ProductSpans& product, DeviceSpan<const uint16_t> x, DeviceSpan<const uint16_t> w) override {
    return form(product, x.data, w.data, true);
  }
  bool multiply(const ProductSpans& product, DeviceSpan<const float> x, DeviceSpan<const float> w) override {
    return form(product, x.data, w.data, false);
  }

 private:
  const CublasLtFunctions& api() const { return lt_->functions(); }

  bool form(const ProductSpans& p, const void* x, const void* w, bool halves) {
    if (p.rows <= 0 || p.outputs <= 0 || p.depth <= 0) return false;
    const LtEpilogue epilogue = lt_epilogue(p.bias != nullptr, p.activation);
    const LtShape shape{halves,
                        p.rows,
                        p.outputs,
                        p.depth,
                        epilogue,
                        alignment_of(x),
                        alignment_of(w),
                        alignment_of(p.y.data),
                        epilogue.bias ? alignment_of(p.bias) : 0};
    pool_.context().use();  // the library chooses for the current device, and wants it to be its stream's
    {
      const std::lock_guard<std::mutex> lock(mutex_);  // a plan holds the bias of the product that it serves
      LtPlan& plan = plan_of(shape, p.bias);
      if (plan.possible) plan.possible = run(plan, p, x, w);
      if (!plan.possible) return false;
    }
    if (epilogue.activate_after) activate(pool_.context(), {p.y, p.y, p.rows, p.outputs}, p.bias, p.activation);
    return true;
  }

  bool run(const LtPlan& plan, const ProductSpans& p, const void* x, const void* w) {
    const float one = 1.0f, zero = 0.0f;
    // Back to the pool at once: later work with it is later on the stream.
    const size_t bytes = plan.choice.workspaceSize;
    const std::shared_ptr<void> workspace = bytes == 0 ? nullptr : pool_.take(bytes, "partial sums of a product");
    const cublasStatus_t status =
        api().multiply(lt_->handle(), plan.operation.get(), &one, w, plan.left.get(), x, plan.right.get(), &zero,
                       p.y.data, plan.result.get(), p.y.data, plan.result.get(), &plan.choice.algo, workspace.get(),
                       bytes, pool_.context().stream());
    if (status == CUBLAS_STATUS_NOT_SUPPORTED) return false;
    lt_->check(status, "product");
    return true;
  }

  LtPlan& plan_of(const LtShape& shape, const float* bias) {
    auto found = plans_.find(shape);
    if (found == plans_.end()) found = plans_.emplace(shape, make_plan(shape, bias)).first;
    if (shape.epilogue.bias) set_bias(found->second, bias);
    return found->second;
  }

  LtPlan make_plan(const LtShape& shape, const float* bias) {
    const LtLayout l = lt_layout(shape.rows, shape.outputs, shape.depth);
    const cudaDataType_t operands = shape.halves ? CUDA_R_16BF : CUDA_R_32F;
    // CUBLAS_COMPUTE_32F sums in float32, and takes float32 operands as they are: TF32 would be another type.
    cublasLtMatmulDesc_t operation = nullptr;
    lt_->check(api().create_operation(&operation, CUBLAS_COMPUTE_32F, CUDA_R_32F), "description of a product");
    LtPlan plan{{operation, api().destroy_operation},
                layout(l.left, operands),
                layout(l.right, operands),
                layout(l.result, CUDA_R_32F),
                {},
                false};
    set(plan, CUBLASLT_MATMUL_DESC_TRANSA, l.left.transposed ? CUBLAS_OP_T : CUBLAS_OP_N);
    set(plan, CUBLASLT_MATMUL_DESC_TRANSB, l.right.transposed ? CUBLAS_OP_T : CUBLAS_OP_N);
    const bool adds = shape.epilogue.bias, relu = shape.epilogue.relu;
    set(plan, CUBLASLT_MATMUL_DESC_EPILOGUE,
        relu ? (adds ? CUBLASLT_EPILOGUE_RELU_BIAS : CUBLASLT_EPILOGUE_RELU)
             : (adds ? CUBLASLT_EPILOGUE_BIAS : CUBLASLT_EPILOGUE_DEFAULT));
    if (adds) set_bias(plan, bias);  // the choice looks at its alignment
    choose(plan, shape);
    return plan;
  }

  void choose(LtPlan& plan, const LtShape& shape) {
    cublasLtMatmulPreference_t raw = nullptr;
    lt_->check(api().create_preference(&raw), "preference");
    const LtOwner<cublasLtMatmulPreference_t> preference(raw, api().destroy_preference);
    const auto prefer = [&](cublasLtMatmulPreferenceAttributes_t attribute, const auto& value) {
      lt_->check(api().set_preference(raw, attribute, &value, sizeof(value)), "preference");
    };
    prefer(CUBLASLT_MATMUL_PREF_MAX_WORKSPACE_BYTES, kMostWorkspaceBytes);
    // Partial sums in a step of their own, in float32: the order of sums does not depend on which block is first.
    prefer(CUBLASLT_MATMUL_PREF_REDUCTION_SCHEME_MASK, uint32_t(CUBLASLT_REDUCTION_SCHEME_COMPUTE_TYPE));
    prefer(CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_A_BYTES, shape.w_alignment);
    prefer(CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_B_BYTES, shape.x_alignment);
    prefer(CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_C_BYTES, shape.y_alignment);
    prefer(CUBLASLT_MATMUL_PREF_MIN_ALIGNMENT_D_BYTES, shape.y_alignment);
    int count = 0;
    const cublasStatus_t status =
        api().choose_algorithm(lt_->handle(), plan.operation.get(), plan.left.get(), plan.right.get(),
                               plan.result.get(), plan.result.get(), raw, 1, &plan.choice, &count);
    // No algorithm, or none for such matrices: the plan stays, so that nobody asks again.
    if (status == CUBLAS_STATUS_NOT_SUPPORTED || status == CUBLAS_STATUS_INVALID_VALUE) return;
    lt_->check(status, "choice of an algorithm");
    plan.possible = count > 0 && plan.choice.state == CUBLAS_STATUS_SUCCESS;
  }

  LtOwner<cublasLtMatrixLayout_t> layout(const ColumnMajorMatrix& m, cudaDataType_t type) const {
    cublasLtMatrixLayout_t raw = nullptr;
    lt_->check(api().create_layout(&raw, type, uint64_t(m.rows), uint64_t(m.columns), m.leading), "layout of a matrix");
    return {raw, api().destroy_layout};
  }

  /// Operations and epilogues are 32 bits wide, as the attributes are.
  template <class Value>
  void set(const LtPlan& plan, cublasLtMatmulDescAttributes_t attribute, Value value) const {
    const auto bits = static_cast<uint32_t>(value);
    lt_->check(api().set_operation(plan.operation.get(), attribute, &bits, sizeof(bits)), "description of a product");
  }
  void set_bias(const LtPlan& plan, const float* bias) const {
    lt_->check(api().set_operation(plan.operation.get(), CUBLASLT_MATMUL_DESC_BIAS_POINTER, &bias, sizeof(bias)),
               "bias");
  }

  DevicePool& pool_;
  std::shared_ptr<CublasLt> lt_;
  std::mutex mutex_;
  std::map<LtShape, LtPlan> plans_;  ///< few: a network has a handful of shapes per size of image
};

}  // namespace

std::unique_ptr<LibraryProducts> make_lt_products(DevicePool& pool, std::shared_ptr<CublasLt> lt) {
  return std::make_unique<LtProducts>(pool, std::move(lt));
}

}  // namespace aligngs::cuda

#endif

namespace aligngs::cuda {

LibraryStart start_lt_products([[maybe_unused]] DevicePool& pool) {
#ifdef ALIGNGS_CUDA_EMULATED
  return {};
#elif defined(ALIGNGS_CUBLAS_LT)
  pool.context().use();  // the library starts on the current device
  std::string reason;
  std::shared_ptr<CublasLt> lt = CublasLt::start(load_cublas_lt(cublas_lt_names()), reason);
  if (lt == nullptr) return {nullptr, reason};
  return {make_lt_products(pool, std::move(lt)), {}};
#else
  return {nullptr, "built without the headers of cuBLASLt"};
#endif
}

}  // namespace aligngs::cuda
