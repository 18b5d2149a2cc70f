#pragma once
// One parameter of a run, as a report lists it.

#include <string>

namespace abrade::examples {

/// A parameter as it was used.
struct Parameter {
    std::string key{};         ///< "water.depth"
    std::string value{};       ///< as text
    std::string unit{};        ///< "m"; empty when dimensionless
    std::string help{};        ///< what it is
    std::string assumption{};  ///< why this value, where the source of the model leaves it open; else empty
    std::string origin{};      ///< "file", "default" or "--set"
};

}  // namespace abrade::examples
