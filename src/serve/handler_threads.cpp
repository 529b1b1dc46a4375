#include "serve/handler_threads.h"

#include <new>

namespace aligngs {

Error error_of(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return Error({ErrorKind::kResources, "out of memory", {}, {}, {}});
  } catch (const std::exception& error) {
    return Error({ErrorKind::kFailed, error.what(), {}, {}, {}});
  }
}

HandlerThreads::~HandlerThreads() {
  for (net::thread_pool* pool : {&workers_, &compressors_, &prompt_}) {
    pool->stop();
    pool->join();
  }
}

}  // namespace aligngs
