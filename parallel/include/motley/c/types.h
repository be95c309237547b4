// What the whole C interface uses: statuses, the text of the last error, vectors, handles and initialisers.
#ifndef MOTLEY_C_TYPES_H
#define MOTLEY_C_TYPES_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

/// The version of the binary interface that this header describes. It grows when a struct gets a field or the library a
/// function; a library serves hosts of every version up to its own.
#define MOTLEY_C_VERSION 2
/// MOTLEY_C_VERSION of the library that is linked. A host that finds a lower one than its header's was built for a newer
/// library.
int32_t motley_c_version(void);

/// How a call ended. Unless it is MOTLEY_DONE, the call has changed nothing, what its pointers point to included (but for the
/// report of motley_solver_step()), and motley_last_error() says why.
typedef enum motley_status {
    MOTLEY_DONE = 0,
    MOTLEY_REFUSED = 1,        ///< bad input; the text names the field, its value and the valid range
    MOTLEY_OUT_OF_MEMORY = 2,  ///< motley_solver_step() says MOTLEY_REFUSED instead
    MOTLEY_FILE_ERROR = 3,  ///< a file or saved bytes cannot be read or written; the text says what is wrong
    MOTLEY_FAILED = 4       ///< anything else that went wrong in the library or in what the host lent it
} motley_status;

/// Why the last call of this thread that was not MOTLEY_DONE ended so, as in "motley_scene_add_body: BodyDefinition.mass is -1;
/// expected 1e-10 to 1e10 (kg)"; at most 1,023 characters, empty before the first such call. What
/// the C++ interface refuses has its names: BodyDefinition is motley_body_definition, and fields are called the same. Never
/// null; valid until the next failing call of this thread.
const char* motley_last_error(void);

/// Frees memory that a call of this interface gave to the host. Null is allowed.
void motley_free(void* memory);

/// Functions of the host that the library calls for memory instead of operator new and operator delete. Threads may call them
/// at the same time. Neither may throw. Never changes.
typedef struct motley_memory_hooks {
    /// Returns `bytes` (above 0) aligned to `alignment` (a power of two), or null where there are none: then the call of the
    /// library ends with MOTLEY_OUT_OF_MEMORY, or MOTLEY_REFUSED for a step.
    void* (*allocate)(size_t bytes, size_t alignment, void* user);
    /// Takes back what `allocate` returned for the same `bytes` and `alignment`.
    void (*release)(void* memory, size_t bytes, size_t alignment, void* user);
    void* user;  ///< passed on to both
} motley_memory_hooks;

/// From now on all that grows with what is in scenes, solvers and indices is in memory of these hooks; with null, of operator new
/// again. Not asked for here is the memory that motley_free() frees, that in which queries gather what they find, the text of
/// errors, a fixed number of objects a scene and a solver, that of MOTLEY_DIRECT, and that of threads by oneTBB. MOTLEY_REFUSED
/// for one function without the other, and for any change while the library holds memory: set hooks before the first scene. One
/// thread at a time.
motley_status motley_set_memory_hooks(const motley_memory_hooks* hooks);

/// Bytes that the library holds now of the memory that hooks would serve, whether there are any or not.
size_t motley_bytes_held(void);

/// 0: no; 1: yes. Other values are refused.
typedef int32_t motley_bool;

// Vectors, quaternions and symmetric matrices, plain as those of any host. They never change.

typedef struct motley_vec2f {
    float x, y;
} motley_vec2f;

typedef struct motley_vec2d {
    double x, y;
} motley_vec2d;

typedef struct motley_vec3f {
    float x, y, z;
} motley_vec3f;

typedef struct motley_vec3d {
    double x, y, z;
} motley_vec3d;

/// Unit quaternion, w scalar, rotating body to world.
typedef struct motley_quatf {
    float x, y, z, w;
} motley_quatf;

typedef struct motley_quatd {
    double x, y, z, w;
} motley_quatd;

/// Symmetric 3x3 matrix.
typedef struct motley_sym3f {
    float xx, xy, xz, yy, yz, zz;
} motley_sym3f;

// Handles: a slot, and the generation that the slot had when the handle was given out. All zero is the null handle. A
// handle is valid until its object is removed; after that it is refused, and never names another object until the slot
// has been reused 2^32 times. Other scenes refuse it too, unless they are copies of its scene or were read from its bytes.

typedef struct motley_body_id {
    uint32_t slot, generation;
} motley_body_id;

/// Names a joint of any type.
typedef struct motley_constraint_id {
    uint32_t slot, generation;
} motley_constraint_id;

typedef struct motley_wall_id {
    uint32_t slot, generation;
} motley_wall_id;

typedef struct motley_shape_id {
    uint32_t slot, generation;
} motley_shape_id;

/// A scene: bodies, joints, shapes, and what is remembered of contacts from step to step.
typedef struct motley_scene motley_scene;
/// Steps scenes; holds settings, buffers and threads.
typedef struct motley_solver motley_solver;

/// Declares the initialisers of the struct motley_NAME, which begins with its `struct_size`. motley_default_NAME()
/// returns one with the defaults that its comments give. motley_init_NAME() writes the same to `value`, whose size in
/// the host's header is `struct_size` bytes, and is what a host in another language than C calls.
#define MOTLEY_DECLARE_DEFAULT(name)                                                \
    motley_status motley_init_##name(motley_##name* value, size_t struct_size);     \
    static inline motley_##name motley_default_##name(void)                         \
    {                                                                               \
        motley_##name value;                                                        \
        value.struct_size = 0; /* refused, should the library not know this size */ \
        (void)motley_init_##name(&value, sizeof value);                             \
        return value;                                                               \
    }

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
#endif
