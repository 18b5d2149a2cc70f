#pragma once
// The pictures and the report of an invert channel's run.

#include "results.hpp"

#include <abrade/io/output_folder.hpp>

namespace abrade::examples {

/// Draws the run into the folder and writes report.html beside the pictures.
void write_report(const ChannelConfig& config, const ChannelResults& results, const OutputFolder& folder);

/// What a reader must know of the wear that was found.
std::string validity(const ChannelConfig& config, const ChannelResults& results);

}  // namespace abrade::examples
