#pragma once
// The error of a disk, as opposed to InputError, the error of an input.

#include <stdexcept>

namespace abrade {

/// A file could not be written or read to its end: disk full, folder gone, broken file.
struct FileError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace abrade
