#pragma once
// What a refused call says.

#include <abrade/core/require.hpp>

#include <string>

/// The message of the error that `call` throws.
template <class Error = abrade::InputError, class Call>
std::string message_of(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "nothing was thrown";
}
