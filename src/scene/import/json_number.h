// Numbers in JSON that other programs wrote. src/scene/import internal.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace aligngs {

/// A number, also one that is written as a text; NaN where it is none.
double number_of_json(const nlohmann::json& value);

/// Whether number_of_json() reads the value. "NaN" and "Infinity" are numbers, though not finite.
bool is_number_of_json(const nlohmann::json& value);

/// Why a value is no number, for messages: "expected a number, found \"abc\"". Long values are cut.
std::string no_number(const nlohmann::json& value);

}  // namespace aligngs
