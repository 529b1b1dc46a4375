#include "device/device_calls.h"

#ifndef ALIGNGS_CUDA_EMULATED

#include "core/error.h"
#include "device/cuda_check.h"
#include "device/cuda_device.h"

namespace aligngs::cuda {

void check_cuda(cudaError_t status, const char* operation) {
  if (status == cudaSuccess) return;
  (void)cudaGetLastError();  // said here; where it can be forgotten at all, the next launch must not report it again
  const bool resources = status == cudaErrorMemoryAllocation || status == cudaErrorNoDevice ||
                         status == cudaErrorInsufficientDriver || status == cudaErrorInvalidDevice ||
                         status == cudaErrorDevicesUnavailable || status == cudaErrorNoKernelImageForDevice;
  throw Error({resources ? ErrorKind::kResources : ErrorKind::kFailed,
               std::string("CUDA, ") + operation + ": " + cudaGetErrorString(status),
               {},
               {},
               "use --device cpu; the last checkpoint is valid"});
}

std::string cuda_build() {
  return "CUDA " + std::to_string(CUDART_VERSION / 1000) + "." + std::to_string(CUDART_VERSION % 1000 / 10) +
         ", architectures " ALIGNGS_CUDA_ARCHITECTURES;
}

namespace calls {

int device_count(std::string& reason) {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess && count > 0) return count;
  (void)cudaGetLastError();
  reason = status == cudaSuccess ? "no CUDA device" : std::string("no CUDA device: ") + cudaGetErrorString(status);
  return 0;
}

int current_device() {
  int device = 0;
  check_cuda(cudaGetDevice(&device), "cudaGetDevice");
  return device;
}
void set_device(int device) { check_cuda(cudaSetDevice(device), "cudaSetDevice"); }

DeviceFacts facts_of(int device) {
  cudaDeviceProp properties{};
  check_cuda(cudaGetDeviceProperties(&properties, device), "cudaGetDeviceProperties");
  return {properties.name,
          properties.major,
          properties.minor,
          properties.sharedMemPerBlockOptin,
          properties.multiProcessorCount,
          properties.totalGlobalMem};
}

bool has_code_for(int major, int minor) { return architectures_run(ALIGNGS_CUDA_ARCHITECTURES, major, minor); }

DeviceMemory memory_of_current_device() {
  size_t free_bytes = 0, total_bytes = 0;
  check_cuda(cudaMemGetInfo(&free_bytes, &total_bytes), "cudaMemGetInfo");
  return {free_bytes, total_bytes};
}

void* allocate(uint64_t bytes) {
  void* memory = nullptr;
  const cudaError_t status = cudaMalloc(&memory, bytes);
  if (status == cudaErrorMemoryAllocation) {
    (void)cudaGetLastError();  // not sticky; the next launch must not report it
    return nullptr;
  }
  check_cuda(status, "cudaMalloc");
  return memory;
}
void release(void* memory) noexcept { (void)cudaFree(memory); }
void withhold(void*, uint64_t) noexcept {}
void hand_out(void*, uint64_t) noexcept {}

void* allocate_pinned(uint64_t bytes) {
  void* memory = nullptr;
  check_cuda(cudaMallocHost(&memory, bytes), "cudaMallocHost");
  return memory;
}
void release_pinned(void* memory) noexcept { (void)cudaFreeHost(memory); }

CUstream_st* create_stream() {
  cudaStream_t stream = nullptr;
  check_cuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreate");
  return stream;
}
void destroy_stream(CUstream_st* stream) noexcept { (void)cudaStreamDestroy(stream); }

void copy_to_device(void* device, const void* host, uint64_t bytes, CUstream_st* stream) {
  check_cuda(cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream), "copy to the device");
  check_cuda(cudaStreamSynchronize(stream), "copy to the device");
}
void copy_to_host(void* host, const void* device, uint64_t bytes, CUstream_st* stream) {
  check_cuda(cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream), "copy to the host");
}
void copy_on_device(void* to, const void* from, uint64_t bytes, CUstream_st* stream) {
  check_cuda(cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToDevice, stream), "copy on the device");
}
void fill_bytes(void* device, unsigned char value, uint64_t bytes, CUstream_st* stream) {
  check_cuda(cudaMemsetAsync(device, value, bytes, stream), "fill");
}
void synchronise(CUstream_st* stream) { check_cuda(cudaStreamSynchronize(stream), "waiting for the device"); }

}  // namespace calls
}  // namespace aligngs::cuda

#endif
