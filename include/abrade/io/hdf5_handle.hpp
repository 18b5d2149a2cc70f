#pragma once
// What every call of the HDF5 C library needs: an identifier that closes itself, silence, and one clear
// reason.

#include <abrade/io/column_of.hpp>

#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace abrade {

namespace hdf5 {

/// While it lives HDF5 prints nothing; then the caller's own setting is back.
class Quiet {
public:
    Quiet() noexcept {
        H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
    Quiet(const Quiet&) = delete;
    Quiet& operator=(const Quiet&) = delete;

private:
    H5E_auto2_t function_ = nullptr;
    void* data_ = nullptr;
};

/// Owns one HDF5 identifier of any kind (file, group, dataset, data space, type, property list).
class Handle {
public:
    Handle() = default;
    explicit Handle(hid_t id) noexcept : id_{id} {}
    Handle(Handle&& other) noexcept : id_{std::exchange(other.id_, H5I_INVALID_HID)} {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    ~Handle() {
        if (id_ < 0) return;
        const Quiet quiet;  // a full disk has been reported by then
        H5Idec_ref(id_);
    }

    hid_t get() const noexcept { return id_; }
    /// False where the HDF5 call that made it failed.
    explicit operator bool() const noexcept { return id_ >= 0; }
    /// Gives the identifier away: the caller closes it.
    hid_t release() noexcept { return std::exchange(id_, H5I_INVALID_HID); }

private:
    hid_t id_ = H5I_INVALID_HID;
};

/// HDF5's name for the numbers of a column.
inline hid_t type_of(const detail::ColumnOf& of) noexcept {
    const auto by_size = [&](hid_t one, hid_t two, hid_t four, hid_t eight) {
        return of.bytes == 1 ? one : of.bytes == 2 ? two : of.bytes == 4 ? four : eight;
    };
    switch (of.kind) {
        case detail::NumberKind::real:
            return of.bytes == 4 ? H5T_NATIVE_FLOAT : H5T_NATIVE_DOUBLE;
        case detail::NumberKind::whole:
            return by_size(H5T_NATIVE_INT8, H5T_NATIVE_INT16, H5T_NATIVE_INT32, H5T_NATIVE_INT64);
        default:
            return by_size(H5T_NATIVE_UINT8, H5T_NATIVE_UINT16, H5T_NATIVE_UINT32, H5T_NATIVE_UINT64);
    }
}

/// What HDF5 says went wrong in the last failed call of this thread: the innermost message of its stack.
inline std::string reason() {
    std::string text;
    const auto take_first = [](unsigned depth, const H5E_error2_t* error, void* out) -> herr_t {
        if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
        return 0;
    };
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &text);
    // Failures of the system come as a page of figures around the one that counts: error message = 'No space
    // left'.
    constexpr std::string_view system = "error message = '";
    if (const auto at = text.find(system); at != std::string::npos) {
        text.erase(0, at + system.size());
        text.erase(std::min(text.find('\''), text.size()));
    }
    return text.empty() ? std::string{"no reason given"} : text;
}

/// "cannot read 'run.h5', bodies/position: <reason>".
inline std::string message(std::string_view action, const std::filesystem::path& file,
                           std::string_view object, std::string_view why) {
    std::string text = "cannot ";
    text.append(action).append(" '").append(file.string()).append("'");
    if (!object.empty()) text.append(", ").append(object);
    return text.append(": ").append(why);
}

}  // namespace hdf5
}  // namespace abrade
