// The error that an action of a test ends with.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"

namespace aligngs {

/// Its whole message. A failure of the test where it has another kind, or where there is none.
template <class Action>
std::string error_of(ErrorKind kind, Action action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "no error";
  return {};
}

}  // namespace aligngs
