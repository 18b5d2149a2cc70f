#pragma once
// Runs gnuplot on a script that stays beside its picture, so that a user can change the one and make the
// other again.

#include <abrade/core/require.hpp>
#include <abrade/io/file_error.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>

namespace abrade::examples {

/// What a gnuplot process said, and how it ended.
struct GnuplotResult {
    int status = 0;  ///< exit code; 127 where there is no gnuplot
    std::string output;
};

/// Runs `gnuplot argument` in `folder` (without a shell, and out of reach of the terminal's Ctrl-C).
inline GnuplotResult run_gnuplot(const std::string& argument, const std::filesystem::path& folder = ".") {
    std::array<int, 2> pipe_ends{};
    if (pipe(pipe_ends.data()) != 0) throw FileError("cannot start gnuplot: no pipe");
    const pid_t child = fork();
    if (child < 0) throw FileError("cannot start gnuplot: no process");
    if (child == 0) {
        setpgid(0, 0);
        dup2(pipe_ends[1], STDOUT_FILENO);
        dup2(pipe_ends[1], STDERR_FILENO);
        close(pipe_ends[0]);
        close(pipe_ends[1]);
        if (chdir(folder.c_str()) == 0)
            execlp("gnuplot", "gnuplot", argument.c_str(), static_cast<char*>(nullptr));
        _exit(127);
    }
    close(pipe_ends[1]);
    GnuplotResult result;
    std::array<char, 4096> buffer{};
    for (ssize_t got = 0;
         (got = read(pipe_ends[0], buffer.data(), buffer.size())) > 0 || (got < 0 && errno == EINTR);)
        if (got > 0) result.output.append(buffer.data(), static_cast<std::size_t>(got));
    close(pipe_ends[0]);
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

/// Call it before a long run whose end needs pictures: InputError where there is no gnuplot.
inline void require_gnuplot() {
    if (run_gnuplot("--version").status != 0)
        fail({"gnuplot", "installed", {}, "install it (Debian: apt-get install gnuplot-nox)"}, "none");
}

/// A text as gnuplot reads it: in single quotes, where nothing is expanded.
inline std::string gnuplot_text(std::string_view text) {
    std::string quoted = "'";
    for (const char c : text) {
        if (c == '\'') quoted += '\'';
        quoted += c == '\n' ? ' ' : c;
    }
    return quoted + "'";
}

/// A number as gnuplot reads it; what is not finite is left out of a picture.
inline std::string gnuplot_number(Real value) { return std::isfinite(value) ? to_text(value) : "NaN"; }

/// Writes `script` to picture.gp and `data` to picture.dat beside `picture`, runs it there, and checks that
/// the picture came out. The script is given the terminal and the output; it names the data file as the
/// variable `data`.
inline void make_picture(const std::filesystem::path& picture, const std::string& script,
                         const std::string& data, int width, int height) {
    namespace fs = std::filesystem;
    const auto beside = [&](const char* extension) { return fs::path{picture}.replace_extension(extension); };
    const auto write = [](const fs::path& path, const std::string& text) {
        std::ofstream file{path, std::ios::binary};
        file << text;
        file.close();
        if (!file) throw FileError("cannot write '" + path.string() + "'");
    };
    write(beside(".dat"), data);
    write(beside(".gp"), "# gnuplot " + beside(".gp").filename().string() + "\nset encoding utf8\n" +
                             "set terminal pngcairo noenhanced size " + std::to_string(width) + "," +
                             std::to_string(height) + " font 'sans,15' linewidth 1.5 background '#ffffff'\n" +
                             "set output " + gnuplot_text(picture.filename().string()) +
                             "\ndata = " + gnuplot_text(beside(".dat").filename().string()) + "\n" + script);
    std::error_code ignored;
    fs::remove(picture, ignored);
    const fs::path folder = picture.has_parent_path() ? picture.parent_path() : fs::path{"."};
    const GnuplotResult result = run_gnuplot(beside(".gp").filename().string(), folder);
    if (result.status == 127) require_gnuplot();
    const auto size = fs::file_size(picture, ignored);
    if (result.status != 0 || ignored || size == 0)
        throw FileError(
            "gnuplot made no picture from '" + beside(".gp").string() +
            "': " + (result.output.empty() ? "exit code " + std::to_string(result.status) : result.output));
}

}  // namespace abrade::examples
