// Scenes as a whole: made, copied, saved and loaded.
#ifndef MOTLEY_C_SCENE_H
#define MOTLEY_C_SCENE_H

#include "motley/c/types.h"

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// Errors, energy and momentum of a scene, computed in double from definitions and poses. This struct never changes.
typedef struct motley_scene_errors {
    double joint_separation_rms;  ///< m, over all joints but servos, which pull and hold nothing
    double joint_separation_max;  ///< m
    double joint_angle_rms;       ///< rad, over the same joints
    double joint_angle_max;       ///< rad
    double kinetic_energy;        ///< J
    double momentum[3];           ///< kg m/s, linear, world
} motley_scene_errors;

/// Makes an empty scene. The host destroys it.
motley_status motley_scene_create(motley_scene** scene);
/// Makes a copy, which continues with the same bits; handles of the one are those of the other.
motley_status motley_scene_copy(const motley_scene* scene, motley_scene** copy);
/// Null is allowed. No other call may use the scene at the same time or later.
void motley_scene_destroy(motley_scene* scene);

/// 64-bit hash of every body's position, orientation and velocity bits, in slot order.
motley_status motley_scene_state_hash(const motley_scene* scene, uint64_t* hash);
/// Position errors of the joints, energy and momentum of the bodies, as they are now.
motley_status motley_scene_measure_errors(const motley_scene* scene, motley_scene_errors* errors);
/// Reorders the bodies so that neighbours in space are neighbours in memory. Handles stay valid and results keep every
/// bit. Makes the steps of a large crowd faster after its people have mixed; costs about as much as a step.
motley_status motley_scene_renumber_bodies(motley_scene* scene);
/// Seconds that the last step took, and its last substep: an impulse divided by them is a mean force. 0 before the first step.
motley_status motley_scene_last_step(const motley_scene* scene, float* seconds);
motley_status motley_scene_last_substep(const motley_scene* scene, float* seconds);

/// Everything that decides what the next steps compute, as bytes: bodies, joints, handles, user data, colours, and the
/// accumulated impulses. The memory becomes the host's, which frees it by motley_free().
motley_status motley_scene_save(const motley_scene* scene, void** bytes, size_t* size);
/// Makes a scene of such bytes, of the same version of the format and the same layout of data in memory. It continues
/// with the same bits, and the handles stay valid. MOTLEY_FILE_ERROR where the bytes are no scene, truncated or corrupted.
motley_status motley_scene_load(const void* bytes, size_t size, motley_scene** scene);
/// The same in a file, which appears completely or not at all.
motley_status motley_scene_save_file(const motley_scene* scene, const char* file);
motley_status motley_scene_load_file(const char* file, motley_scene** scene);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
