// Format: https://numpy.org/doc/stable/reference/generated/numpy.savez_compressed.html
#include "io/npz.h"

#include "core/error.h"
#include "io/atomic_file.h"
#include "io/zip_archive.h"
#include "io/zip_writer.h"

namespace aligngs {
namespace {

constexpr uint64_t kMaxArrayBytes = uint64_t(4) << 30;  // bytes: a map of 150 classes at 2000 x 1500 pixels in float64
constexpr uint64_t kHeaderBytes = 4096;                 // bytes that hold any header that NumPy writes

const ZipEntry& only_array(const ZipArchive& archive) {
  if (archive.entries().size() != 1) {
    throw_bad_input(archive.name(), "arrays",
                    std::to_string(archive.entries().size()) + " arrays in the archive, and one is expected",
                    "write it with numpy.savez_compressed and one array");
  }
  return archive.entries().front();
}

FloatArray read_archive(const ZipArchive& archive) {
  return decode_npy(archive.read(only_array(archive), kMaxArrayBytes), archive.name());
}

}  // namespace

FloatArray read_npz(const std::filesystem::path& path) { return read_archive(ZipArchive(file_source(path))); }

FloatArray decode_npz(const std::string& bytes, const std::filesystem::path& name_for_errors) {
  return read_archive(ZipArchive(memory_source(bytes, name_for_errors)));
}

ArrayHeader read_npz_header(const std::filesystem::path& path) {
  const ZipArchive archive(file_source(path));
  const ZipEntry& array = only_array(archive);
  return decode_npy_header(archive.read_beginning(array, kHeaderBytes), array.size, path);
}

void write_npz_float16(const std::filesystem::path& path, const std::vector<int64_t>& shape, const uint16_t* data) {
  const std::string array = encode_npy_float16(path, shape, data);
  write_file_atomically(path, make_deflated_zip({{"arr_0.npy", array}}));
}

}  // namespace aligngs
