// Time and memory of the full-size networks on random weights, and the speed of their layer types.
// Usage: network_benchmark layers|vggt|m2f|dpt|da3|eomt [--frames N] [--size WxH] [--threads T] [--weights FOLDER]
//                          [--precision bfloat16|float16|float32] [--instructions all|avx512|avx2|sse4] [--no-onednn]
// With --instructions the products are the project's own: oneDNN chooses its vectors itself.
// Missing files of random weights are written to the folder (default: the system's folder for temporary files). Sizes:
// 2.4 GB for vggt, 3.4 GB for m2f, 0.7 GB for dpt, 0.3 GB for da3, 0.6 GB for eomt.
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>
#include <string>

#include "core/choice_words.h"
#include "core/error.h"
#include "core/random.h"
#include "engine/benchmark/instruction_limit.h"
#include "engine/benchmark/machine_ceilings.h"
#include "nn/attention.h"
#include "nn/cpu/matrix_backend.h"
#include "nn/da3/da3.h"
#include "nn/depther.h"
#include "nn/eomt/eomt_weights.h"
#include "nn/eomt/semantic.h"
#include "nn/mask2former.h"
#include "nn/random_weights.h"
#include "nn/vggt.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string what;
  int64_t frames = 20, width = 0, height = 0;
  int threads = 0;
  nn::Precision precision = nn::fastest_precision();
  bool onednn = true;
  Instructions instructions = Instructions::kAll;
  fs::path weights = fs::temp_directory_path() / "aligngs_random_weights";
};

/// On a machine that does other work too, the processor time (of all threads) tells more.
struct Elapsed {
  double wall = 0, processor = 0;
};

Elapsed time_of(const std::function<void()>& work) {
  const auto processor_time = [] {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
  };
  const auto start = std::chrono::steady_clock::now();
  const double before = processor_time();
  work();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), processor_time() - before};
}
double seconds_of(const std::function<void()>& work) { return time_of(work).wall; }

double peak_gigabytes() {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0;
  while (status >> word) {
    if (word == "VmHWM:") status >> kilobytes;
  }
  return kilobytes / 1e6;
}

fs::path weights_at(const Arguments& arguments, const std::string& name, const nn::TensorList& tensors) {
  const fs::path path = arguments.weights / name;
  if (!fs::exists(path)) {
    constexpr uint64_t kSeed = 1;
    std::printf("writing %s: %.1f s\n", path.c_str(),
                seconds_of([&] { nn::write_random_weights(path, tensors, kSeed); }));
  }
  return path;
}

nn::FeatureMap random_image(int64_t width, int64_t height, double low, double high) {
  nn::FeatureMap image(height, width, 3);
  Random random(1);
  for (float& v : image.data) v = float(random.uniform(low, high));
  return image;
}

/// Best rate of products on this machine in GFLOP/s. Arithmetic is that of matrix tiles where the network uses them,
/// else that of float32. There is no such figure for bfloat16 products of oneDNN without tiles: 0.
double ceiling_of(nn::Compute& compute) {
  if (compute.amx()) return measure_amx_gflops(compute.pool());
  if (compute.matrices()->name() == "oneDNN" && compute.precision() == nn::Precision::kBfloat16) return 0;
  return measure_fma_gflops(compute.pool());
}

void report(const char* name, double loading, nn::Compute& compute, const std::function<void()>& work) {
  const double before = compute.operations(), slower = ceiling_of(compute);
  const Elapsed running = time_of(work);
  const double flop = compute.operations() - before, ceiling = std::max(slower, ceiling_of(compute));
  std::printf("%s: loading %.1f s, running %.1f s (%.1f s of processors), peak memory %.2f GB\n", name, loading,
              running.wall, running.processor, peak_gigabytes());
  std::printf("%.2f TFLOP of products, %.0f GFLOP/s", flop / 1e12, flop / running.wall / 1e9);
  if (ceiling > 0) std::printf(", %.0f %% of the ceiling of %.0f", flop / running.wall / 1e7 / ceiling, ceiling);
  std::printf("\n");
}

void run_vggt(nn::Compute& compute, const Arguments& a) {
  const fs::path path = weights_at(a, "vggt_1b.safetensors", nn::vggt_tensors({}));
  std::unique_ptr<nn::Vggt> network;
  const double loading = seconds_of([&] { network = std::make_unique<nn::Vggt>(compute, nn::Weights::open(path)); });
  const int64_t width = a.width > 0 ? a.width : 518, height = a.height > 0 ? a.height : 392;
  std::vector<nn::FeatureMap> images(size_t(a.frames), random_image(width, height, 0, 1));
  report("VGGT-1B", loading, compute, [&] {
    (*network)(compute, std::move(images), {true, true}, [](int64_t, nn::VggtFrame) {});
  });
}

void run_mask2former(nn::Compute& compute, const Arguments& a) {
  const fs::path path = weights_at(a, "vitg_m2f.safetensors", nn::mask2former_tensors({}));
  std::unique_ptr<nn::Mask2Former> network;
  const double loading =
      seconds_of([&] { network = std::make_unique<nn::Mask2Former>(compute, nn::Weights::open(path)); });
  const int64_t width = a.width > 0 ? a.width : 896, height = a.height > 0 ? a.height : 896;
  const nn::FeatureMap image = random_image(width, height, -2, 2);
  report("ViT-g Mask2Former, one window", loading, compute, [&] { network->predict(compute, image); });
}

void run_dpt(nn::Compute& compute, const Arguments& a) {
  const nn::VitSize size = nn::vit_size('l');
  const nn::Weights backbone = nn::Weights::open(weights_at(a, "dinov2_vitl14.safetensors", nn::dinov2_tensors(size)));
  const nn::Weights head =
      nn::Weights::open(weights_at(a, "dinov2_vitl14_dpt.safetensors", nn::dpt_head_tensors(size)));
  std::unique_ptr<nn::DepthNetwork> network;
  const double loading = seconds_of([&] { network = nn::make_depth_network(compute, backbone, head); });
  const nn::FeatureMap image = random_image(a.width > 0 ? a.width : 640, a.height > 0 ? a.height : 480, -2, 2);
  (*network)(compute, image);
  report("ViT-L DPT, one image", loading, compute, [&] { (*network)(compute, image); });
}

void run_da3(nn::Compute& compute, const Arguments& a) {
  const fs::path path = weights_at(a, "da3_base.safetensors", nn::da3_tensors(nn::da3_size('b')));
  std::unique_ptr<nn::Da3> network;
  const double loading = seconds_of([&] { network = std::make_unique<nn::Da3>(compute, nn::Weights::open(path)); });
  const int64_t width = a.width > 0 ? a.width : 504, height = a.height > 0 ? a.height : 378;
  const std::vector<nn::FeatureMap> images(size_t(a.frames), random_image(width, height, -2, 2));
  report("DA3-Base", loading, compute, [&] { (*network)(compute, images, {}, [](int64_t, nn::Da3Frame) {}); });
}

void run_eomt(nn::Compute& compute, const Arguments& a) {
  const fs::path path = weights_at(a, "eomt_large_512.safetensors", nn::eomt_tensors());
  std::unique_ptr<nn::Eomt> network;
  const double loading =
      seconds_of([&] { network = std::make_unique<nn::Eomt>(compute, nn::eomt_weights(WeightFile::open(path))); });
  const int width = a.width > 0 ? int(a.width) : 640, height = a.height > 0 ? int(a.height) : 480;
  const Image<uint8_t> photo(width, height, 3, 128);
  report("EoMT-L, one photo", loading, compute,
         [&] { nn::eomt_scores(compute, *network, photo, height / 8, width / 8); });
}

/// The best of several runs in GFLOP/s, and its share of the ceiling, which is measured in turn with them.
void rate(nn::Compute& compute, const char* name, double flop, const std::function<void()>& work) {
  Elapsed best{1e30, 1e30};
  double ceiling = 0;
  constexpr int kRuns = 5;
  for (int i = 0; i < kRuns; ++i) {
    ceiling = std::max(ceiling, ceiling_of(compute));
    const Elapsed run = time_of(work);
    best.wall = std::min(best.wall, run.wall);
    best.processor = std::min(best.processor, run.processor);
  }
  std::printf("%-40s %6.0f GFLOP/s, %5.0f GFLOP per second of a processor", name, flop / best.wall / 1e9,
              flop / best.processor / 1e9);
  if (ceiling > 0) std::printf(", %3.0f %% of the ceiling of %.0f", flop / best.wall / 1e7 / ceiling, ceiling);
  std::printf("\n");
}

std::vector<float> random_values(size_t count) {
  std::vector<float> values(count);
  Random random(2);
  for (float& v : values) v = float(random.uniform(-1, 1));
  return values;
}

void run_layers(nn::Compute& compute) {
  const int64_t rows = 10412;  // tokens of ten frames of 392 x 518
  nn::Matrix x(rows, 1024);
  x.data = random_values(x.data.size());
  {
    // The ceiling: the same product again and again, operands in the cache.
    const auto packed = compute.matrices()->pack(random_values(1024 * 1024).data(), 1024, 1024);
    std::vector<float> y(256 * 1024);
    const double flop = 2.0 * 256 * 1024 * 1024;
    const int64_t repeats = 64;
    rate(compute, "product 256 x 1024 x 1024, in the cache", flop * double(repeats), [&] {
      compute.for_rows(repeats, 1, [&](int64_t, int64_t, nn::Scratch& scratch) {
        packed->multiply(x.row(0), 256, scratch.floats(256 * 1024), scratch);
      });
    });
  }
  const auto linear = [&](const char* name, int64_t outputs) {
    const nn::Linear layer(compute, random_values(size_t(outputs) * 1024), outputs, 1024, {});
    nn::Matrix y(rows, outputs);
    y.data.data();  // takes its memory before the clock runs, as blocks of a transformer do
    rate(compute, name, 2.0 * double(rows) * 1024 * double(outputs), [&] {
      compute.for_rows(rows, 0, [&](int64_t begin, int64_t count, nn::Scratch& scratch) {
        layer.product(x.row(begin), count, y.row(begin), scratch);
      });
    });
  };
  linear("linear 1024 -> 3072", 3072);
  linear("linear 1024 -> 4096", 4096);
  const int64_t heads = 16, dim = 64;
  for (const int64_t tokens : {int64_t(1041), rows}) {
    nn::AttentionOperands operands(compute, {rows / tokens, heads, dim, tokens, tokens});
    for (int64_t s = 0; s < rows / tokens; ++s) {
      for (int64_t t = 0; t < tokens; ++t) {
        operands.set_query_row(s, t, x.row(t));
        operands.set_key_row(s, t, x.row(t));
        operands.set_value_row(s, t, x.row(t));
      }
    }
    nn::Matrix out(rows, heads * dim);
    const std::string name = "attention, 16 heads of 64, " + std::to_string(tokens) + " tokens";
    rate(compute, name.c_str(), 4.0 * double(rows) * double(tokens) * double(heads * dim),
         [&] { nn::attention(compute, operands, out.data.data()); });
  }
  nn::FeatureMap map(148, 148, 256);
  map.data = random_values(map.data.size());
  const nn::Convolution conv(compute, {256, 256, 3, 1, 1}, random_values(256 * 256 * 9), {});
  rate(compute, "convolution 3x3, 256 -> 256, 148 x 148", 2.0 * 148 * 148 * 256 * 256 * 9, [&] { conv(compute, map); });
}

/// The choice that a word of an option names.
template <class Choice>
Choice choice_of(const std::string& option, const std::string& word) {
  const std::optional<Choice> choice = choice_named<Choice>(word);
  if (!choice) throw_usage(option + " is " + joined_words<Choice>(", ", " or ") + ", not " + word);
  return *choice;
}

Arguments parse(int count, char** values) {
  Arguments a;
  for (int i = 1; i < count; ++i) {
    const std::string option = values[i];
    const auto next = [&]() -> std::string {
      if (i + 1 >= count) throw_usage("a value is missing after " + option);
      return values[++i];
    };
    if (option == "--frames") {
      a.frames = std::stoll(next());
    } else if (option == "--size") {
      const std::string size = next();
      a.width = std::stoll(size);
      a.height = std::stoll(size.substr(size.find('x') + 1));
    } else if (option == "--threads") {
      a.threads = std::stoi(next());
    } else if (option == "--precision") {
      a.precision = choice_of<nn::Precision>(option, next());
    } else if (option == "--no-onednn") {
      a.onednn = false;
    } else if (option == "--instructions") {
      a.instructions = choice_of<Instructions>(option, next());
    } else if (option == "--weights") {
      a.weights = next();
    } else if (a.what.empty() && option[0] != '-') {
      a.what = option;
    } else {
      throw_usage("unknown option " + option);
    }
  }
  return a;
}

void run(const Arguments& a) {
  ThreadPool pool(a.threads);
  const InstructionLimit limit(a.instructions);
  nn::ComputeOptions options;
  options.precision = a.precision;
  options.onednn = a.onednn && a.instructions == Instructions::kAll;
  nn::Compute compute(pool, options);
  std::printf("%d threads, %s, products of %s, matrix unit %s\n", pool.size(),
              std::string(word_of(a.precision)).c_str(), compute.matrices()->name().c_str(),
              compute.amx() ? "yes" : "no");
  if (a.what == "layers") return run_layers(compute);
  if (a.what == "vggt") return run_vggt(compute, a);
  if (a.what == "m2f") return run_mask2former(compute, a);
  if (a.what == "dpt") return run_dpt(compute, a);
  if (a.what == "da3") return run_da3(compute, a);
  if (a.what == "eomt") return run_eomt(compute, a);
  throw_usage("say what to run: layers, vggt, m2f, dpt, da3 or eomt");
}

}  // namespace
}  // namespace aligngs

int main(int count, char** values) {
  try {
    aligngs::run(aligngs::parse(count, values));
    return 0;
  } catch (const aligngs::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return error.exit_status();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
