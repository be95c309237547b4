// The part of a step that lays contacts and joints out in blocks, on one thread.
#pragma once

#include <gtest/gtest.h>

#include "contact_pipeline.h"
#include "layout/layout.h"
#include "own_executor.h"
#include "scene/scene_core.h"

namespace motley::testing {

inline void lay_out(Layout& layout, Scene& host_scene, std::span<const Contact> contacts,
                    const FigureUse& figures = {})
{
    SceneCore& scene = core_of(host_scene);
    const std::unique_ptr<Executor> executor = make_executor(1);
    StageRunner runner(executor.get());
    ContactPipeline pipeline(runner, layout);
    ASSERT_EQ(pipeline.take_in(scene, contacts, BadContacts::refuse), "");
    ASSERT_EQ(pipeline.lay_out(scene, contacts, {.figures = figures, .adds_up = true}), "");
    scene.contacts.accept_staged();
}

}  // namespace motley::testing
