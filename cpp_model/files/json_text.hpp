// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 raypool maintainers
// JSON as users write it: text to value, and the sentence when it is none.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace raypool {

/// Keys stay in their order. Throws InputError, which begins with `where`, when the text is no JSON, or an object has a
/// key twice, of which one would be lost.
nlohmann::ordered_json parse_json(const std::string& text, const std::string& where);

/// The message of a JSON library's error, without the bracketed tag before it, which means nothing to a user.
std::string json_reason(const std::exception& error);

/// The text of a file, indented by `indent`. Names of files need not be UTF-8, as JSON
/// must be: what is not becomes U+FFFD.
std::string to_text(const nlohmann::ordered_json& json, int indent);

}  // namespace raypool
