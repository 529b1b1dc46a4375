// Every operation of the CUDA engine beside the CPU's on one made-up scene. Prints a table of differences and, on
// request, writes the outputs of both as .npy files.
//   op_compare [--device N] [--width W] [--height H] [--gaussians N] [--channels C] [--dump FOLDER]
// Exit status 0: every channel is within its limit, 1: some is not, 2: usage, 77: no device answers.
#include <charconv>
#include <cstdio>
#include <cstring>
#include <string>

#include "compare_ops.h"
#include "core/error.h"

namespace aligngs::op_compare {
namespace {

constexpr int kNoDevice = 77;  ///< what ctest takes for "skipped"

struct Options {
  int device = -1;  ///< -1: the one with most memory
  BenchmarkRoom room{64, 48, 600, 12};
  std::string dump;
};

template <class Number>
Number number_of(const char* option, const char* text) {
  Number value{};
  const char* end = text + std::strlen(text);
  const auto [last, status] = std::from_chars(text, end, value);
  if (status != std::errc() || last != end) throw_usage(std::string(option) + " needs a number, not \"" + text + "\"");
  return value;
}

Options parse(int argc, char** argv) {
  Options o;
  for (int i = 1; i < argc; ++i) {
    const std::string name = argv[i];
    if (i + 1 == argc)
      throw_usage("option " + name + " needs a value, or does not exist", "see the head of op_compare.cpp");
    const char* value = argv[++i];
    if (name == "--device") {
      o.device = number_of<int>("--device", value);
    } else if (name == "--width") {
      o.room.width = number_of<int>("--width", value);
    } else if (name == "--height") {
      o.room.height = number_of<int>("--height", value);
    } else if (name == "--gaussians") {
      o.room.gaussians = number_of<size_t>("--gaussians", value);
    } else if (name == "--channels") {
      o.room.channels = number_of<int>("--channels", value);
    } else if (name == "--dump") {
      o.dump = value;
    } else {
      throw_usage("op_compare has no option " + name, "see the head of op_compare.cpp");
    }
  }
  return o;
}

int run(const Options& options) {
  const cuda::DeviceChoice choice = cuda::choose_device("auto", cuda::list_cuda_devices(), true);
  if (!choice.cuda) {
    std::printf("skipped: %s\n", choice.message.c_str());
    return kNoDevice;
  }
  const int device = options.device >= 0 ? options.device : choice.index;
  const CompareScene scene = make_compare_scene(options.room);
  OpTable table(options.dump);
  {
    cuda::DeviceContext context(device);
    const CpuStep step(context, scene);
    compare_forward(context, step, table);
    compare_backward(context, step, table);
    compare_semantics(context, step, table);
    compare_multi_view(context, options.room, table);
    compare_updates(context, step, table);
  }
  compare_engines(device, scene, table);
  compare_fusion(device, table);
  compare_networks(device, table);
  std::printf("%d x %d pixels, %zu Gaussians, %d channels, %s\n", options.room.width, options.room.height,
              options.room.gaussians, options.room.channels, cuda::cuda_build().c_str());
  std::fputs(table.text().c_str(), stdout);
  return table.ok() ? 0 : 1;
}

}  // namespace
}  // namespace aligngs::op_compare

int main(int argc, char** argv) {
  try {
    return aligngs::op_compare::run(aligngs::op_compare::parse(argc, argv));
  } catch (const aligngs::Error& error) {
    std::fprintf(stderr, "op_compare: %s\n", error.what());
    return error.kind() == aligngs::ErrorKind::kUsage ? 2 : 1;
  }
}
