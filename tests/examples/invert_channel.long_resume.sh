#!/usr/bin/env bash
# As invert_channel.resume.sh, killed fifty times.
ABRADE_KILLS=50 exec bash "$(dirname "${BASH_SOURCE[0]}")/invert_channel.resume.sh" "$@"
