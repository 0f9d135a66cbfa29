// Base64 (RFC 4648), for data: addresses. Threads: a pure function.
#pragma once

#include <string>
#include <string_view>

namespace silpose {

std::string base64(std::string_view bytes);

}  // namespace silpose
