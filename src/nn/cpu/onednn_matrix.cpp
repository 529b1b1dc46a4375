// The only file that knows oneDNN (2.6 of Debian 12, and 3.x): products of bfloat16 matrices on one thread.
#include "nn/cpu/matrix_backend.h"

#ifdef ALIGNGS_WITH_ONEDNN

#include <dlfcn.h>

#include <dnnl.hpp>
#include <map>
#include <mutex>
#include <tuple>

#include "core/error.h"

namespace aligngs::nn {
namespace {

using dnnl::memory;

constexpr memory::data_type kBfloat16 = memory::data_type::bf16;

/// oneDNN is built on OpenMP, whose threads spin; while one of these lives, the calling thread uses
/// no other. The functions are looked up in whichever OpenMP library oneDNN brought with it.
class OneThread {
 public:
  OneThread() {
    static const auto get = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "omp_get_max_threads"));
    if (!set() || !get) return;
    before_ = get();
    if (before_ != 1) set()(1);
  }
  ~OneThread() {
    if (before_ > 1) set()(before_);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  using Set = void (*)(int);
  static Set set() {
    static const auto function = reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "omp_set_num_threads"));
    return function;
  }
  int before_ = 1;
};

/// A product for one number of rows; primitives are shared by all matrices of a size.
struct Product {
  dnnl::matmul::primitive_desc description;
  dnnl::matmul primitive;
};

class Products {
 public:
  Products() : engine_(dnnl::engine::kind::cpu, 0) {}

  const dnnl::engine& engine() const { return engine_; }

  memory::desc weights(int64_t inputs, int64_t outputs) {
    const memory::desc any({inputs, outputs}, kBfloat16, memory::format_tag::any);
    constexpr int64_t kTypicalRows = 256;
    return describe(kTypicalRows, inputs, outputs, any).weights_desc();
  }

  const Product& product(int64_t rows, int64_t inputs, int64_t outputs, const memory::desc& packed) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto key = std::make_tuple(rows, inputs, outputs);
    auto found = products_.find(key);
    if (found == products_.end()) {
      Product made;
      made.description = describe(rows, inputs, outputs, packed);
      made.primitive = dnnl::matmul(made.description);
      found = products_.emplace(key, std::move(made)).first;
    }
    return found->second;
  }

 private:
  dnnl::matmul::primitive_desc describe(int64_t rows, int64_t inputs, int64_t outputs,
                                        const memory::desc& weights) const {
    const memory::desc x({rows, inputs}, kBfloat16, memory::format_tag::ab);
    const memory::desc y({rows, outputs}, memory::data_type::f32, memory::format_tag::ab);
    dnnl::primitive_attr attributes;
    attributes.set_scratchpad_mode(dnnl::scratchpad_mode::user);
#if DNNL_VERSION_MAJOR >= 3
    return {engine_, x, weights, y, attributes};
#else
    return {dnnl::matmul::desc(x, weights, y), attributes, engine_};
#endif
  }

  dnnl::engine engine_;
  std::mutex mutex_;
  std::map<std::tuple<int64_t, int64_t, int64_t>, Product> products_;
};

class OnednnMatrix : public PackedMatrix {
 public:
  OnednnMatrix(std::shared_ptr<Products> products, const float* weights, int64_t outputs, int64_t inputs)
      : PackedMatrix(outputs, inputs, Precision::kBfloat16), products_(std::move(products)) {
    const OneThread one;
    description_ = products_->weights(inputs, outputs);
    packed_ = AlignedBytes(description_.get_size());
    // W [outputs, inputs] row-major is the transposed operand of the product.
    const memory::desc plain({inputs, outputs}, memory::data_type::f32, memory::format_tag::ba);
    memory from(plain, products_->engine(), const_cast<float*>(weights));
    memory to(description_, products_->engine(), packed_.get());
    dnnl::stream stream(products_->engine());
    dnnl::reorder(from, to).execute(stream, from, to);
    stream.wait();
  }

  size_t bytes() const override { return packed_.size(); }

  void multiply_packed(const void* x, int64_t rows, float* y, Scratch& scratch) const override {
    const OneThread one;
    const Product& product = products_->product(rows, inputs(), outputs(), description_);
    const Scratch::Frame frame(scratch);
    const memory::desc room = product.description.scratchpad_desc();
    const dnnl::engine& engine = products_->engine();
    dnnl::stream stream(engine);
    const memory source(product.description.src_desc(), engine, const_cast<void*>(x));
    const memory weights(description_, engine, const_cast<char*>(packed_.get()));
    const memory result(product.description.dst_desc(), engine, y);
    const memory workspace(room, engine, scratch.bytes(room.get_size()));
    product.primitive.execute(stream, {{DNNL_ARG_SRC, source},
                                       {DNNL_ARG_WEIGHTS, weights},
                                       {DNNL_ARG_DST, result},
                                       {DNNL_ARG_SCRATCHPAD, workspace}});
    stream.wait();
  }

 private:
  std::shared_ptr<Products> products_;
  memory::desc description_;
  AlignedBytes packed_;
};

class OnednnBackend : public MatrixBackend {
 public:
  std::string name() const override { return "oneDNN"; }
  std::unique_ptr<PackedMatrix> pack(const float* weights, int64_t outputs, int64_t inputs) const override {
    try {
      return std::make_unique<OnednnMatrix>(products_, weights, outputs, inputs);
    } catch (const dnnl::error& error) {
      throw Error({ErrorKind::kFailed, std::string("oneDNN: ") + error.what(), {}, "matrix", ""});
    }
  }

 private:
  std::shared_ptr<Products> products_ = std::make_shared<Products>();
};

}  // namespace

std::shared_ptr<MatrixBackend> make_onednn_backend() {
  auto backend = std::make_shared<OnednnBackend>();
  try {  // whether it supports the type on this processor shows when it is asked
    constexpr int64_t kSmall = 16;
    const std::vector<float> zeros(kSmall * kSmall, 0.0f);
    backend->pack(zeros.data(), kSmall, kSmall);
  } catch (const Error&) {
    return nullptr;
  }
  return backend;
}

}  // namespace aligngs::nn

#else

namespace aligngs::nn {
std::shared_ptr<MatrixBackend> make_onednn_backend() { return nullptr; }
}  // namespace aligngs::nn

#endif
