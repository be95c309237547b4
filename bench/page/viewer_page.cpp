// See viewer_page.h. The page is put together from the files in page/viewer, which the build made into viewer_files.h.
#include "page/viewer_page.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "recording/recording.h"
#include "viewer_files.h"

namespace motley::bench {
namespace {

std::string text_of(const std::string& path, const char* missing)
{
    std::ifstream in(path, std::ios::binary);
    if (!in) throw std::runtime_error(fmt::format("{}: {}", path, missing));
    return {std::istreambuf_iterator<char>(in), {}};
}

/// RFC 4648.
std::string in_base64(std::string_view bytes)
{
    constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k)
            text.push_back(k > count ? '=' : letters[three >> (18 - 6 * k) & 63]);
    }
    return text;
}

std::string escaped(const std::string& text)
{
    std::string result;
    for (const char c : text) result += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return result;
}

}  // namespace

ViewerPage make_viewer_page(const std::string& recording)
{
    std::int64_t shapes = 0;
    const Recording run = read_recording(recording, [&](const RecordedFrame& frame) {
        shapes += static_cast<std::int64_t>(frame.shapes.size());
    });
    if (run.frames == 0) throw std::runtime_error(fmt::format("{}: has no whole frame", recording));
    const std::string three = text_of(
        MOTLEY_THREE, "cannot be read; it is in Debian's package libjs-three (apt-get install libjs-three)");
    const std::string bytes = text_of(recording, "cannot be read").substr(0, run.whole_size);
    const std::vector<std::pair<std::string_view, std::string>> parts{
        {"@TITLE@", escaped(run.scene)},
        {"@STYLE@", std::string(viewer_style)},
        {"@THREE@", three},
        {"@RECORDING@", in_base64(bytes)},
        {"@DECODER@", std::string(viewer_decoder)},
        {"@VIEWER@", std::string(viewer_code)}};
    std::string html;
    std::string_view rest = viewer_html;
    for (const auto& [mark, text] : parts) {
        const std::size_t at = rest.find(mark);
        html.append(rest.substr(0, at)).append(text);
        rest.remove_prefix(at + mark.size());
    }
    html.append(rest);
    return {std::move(html),
            fmt::format("{} frames, {:.0f} people in the mean{}", run.frames,
                        static_cast<double>(shapes) / static_cast<double>(run.frames),
                        run.is_cut ? "; the recording was cut off, and its last frame is left out" : "")};
}

std::string write_viewer_page(const std::string& recording, const std::string& page)
{
    const ViewerPage made = make_viewer_page(recording);
    std::ofstream out(page, std::ios::binary);
    out << made.html;
    out.close();
    if (!out) throw std::runtime_error(fmt::format("{}: cannot be written", page));
    return fmt::format("{}: {}", page, made.facts);
}

}  // namespace motley::bench
