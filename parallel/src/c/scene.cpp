// Scenes of the C interface as a whole, and as bytes.
#include "motley/c/scene.h"

#include <cstdlib>
#include <new>

#include "handles.h"
#include "motley/core/snapshot.h"
#include "scene_errors.h"

using namespace motley;
using namespace motley::c;

namespace {

/// Writes a handle of the scene that `make` returns to where the host wants it; makes none if it wants it nowhere.
template <class Make>
void give_scene(motley_scene** to, const char* name, const Make& make)
{
    motley_scene*& handle = need(to, name);
    handle = new motley_scene{make()};
}

}  // namespace

motley_status motley_scene_create(motley_scene** scene)
{
    return call(__func__, [&] { give_scene(scene, "scene", [] { return Scene(); }); });
}

motley_status motley_scene_copy(const motley_scene* scene, motley_scene** copy)
{
    return call(__func__, [&] { give_scene(copy, "copy", [&] { return scene_of(scene); }); });
}

void motley_scene_destroy(motley_scene* scene)
{
    delete scene;
}

motley_status motley_scene_state_hash(const motley_scene* scene, uint64_t* hash)
{
    return call(__func__, [&] { need(hash, "hash") = scene_of(scene).state_hash(); });
}

motley_status motley_scene_measure_errors(const motley_scene* scene, motley_scene_errors* errors)
{
    return call(__func__,
                [&] { need(errors, "errors") = as<motley_scene_errors>(scene_of(scene).errors()); });
}

motley_status motley_scene_renumber_bodies(motley_scene* scene)
{
    return call(__func__, [&] { scene_of(scene).renumber_bodies(); });
}

motley_status motley_scene_last_step(const motley_scene* scene, float* seconds)
{
    return call(__func__, [&] { need(seconds, "seconds") = scene_of(scene).last_step(); });
}

motley_status motley_scene_last_substep(const motley_scene* scene, float* seconds)
{
    return call(__func__, [&] { need(seconds, "seconds") = scene_of(scene).last_substep(); });
}

motley_status motley_scene_save(const motley_scene* scene, void** bytes, size_t* size)
{
    return call_on_file(__func__, [&] {
        need(bytes, "bytes");
        need(size, "size");
        const std::vector<std::byte> saved = save_scene(scene_of(scene));
        void* memory = std::malloc(saved.size());
        if (memory == nullptr) throw std::bad_alloc();
        std::memcpy(memory, saved.data(), saved.size());
        *bytes = memory;
        *size = saved.size();
    });
}

motley_status motley_scene_load(const void* bytes, size_t size, motley_scene** scene)
{
    return call_on_file(__func__, [&] {
        check_array(bytes, size, 1, 1, 1, "bytes");
        give_scene(scene, "scene",
                   [&] { return load_scene(std::span(static_cast<const std::byte*>(bytes), size)); });
    });
}

motley_status motley_scene_save_file(const motley_scene* scene, const char* file)
{
    return call_on_file(__func__, [&] { save_scene(scene_of(scene), std::string(&need(file, "file"))); });
}

motley_status motley_scene_load_file(const char* file, motley_scene** scene)
{
    return call_on_file(__func__, [&] {
        give_scene(scene, "scene", [&] { return load_scene(std::string(&need(file, "file"))); });
    });
}
