// Manages the viewer's objects on the device other than images, from opening the device to its
// loss.
#include "viewer/core/device.h"

#include "cli/options.h"
#include "viewer/core/changes.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <stdio.h>

// The number of losses after which the device is not opened again.
#define RECOVERIES_MAX 2u

static struct gpu_params gpu_params(const struct viewer *viewer)
{
    struct gpu_params params = viewer->shell.options->device.gpu;
    params.graphics = true;
    if (viewer->shell.window.handle) {
        params.instance_extensions = window_extensions(&params.instance_extension_count);
        params.can_present = window_can_present;
        params.present_context = (void *)&viewer->shell.window;
    }
    if (viewer->stage.recoveries > 0) // simulated faults must not occur again
        params.lose_device_at_submit = params.fail_allocation = 0;
    return params;
}

bool viewer_open_device(struct viewer *viewer, struct err *err)
{
    struct gpu_params params = gpu_params(viewer);
    struct gpu_atlas atlas;
    gui_atlas(&viewer->shell.gui, &atlas);
    return gpu_open(&params, &viewer->stage.gpu, err) &&
           gpu_screen_create(&viewer->stage.gpu, &atlas, &viewer->stage.screen, err) &&
           display_create(&viewer->stage.gpu, &viewer->stage.display, err) &&
           swapchain_create(&viewer->stage.gpu, &viewer->shell.window,
                            viewer->stage.swapchain.vsync, &viewer->stage.swapchain, err);
}

void viewer_close_device(struct viewer *viewer)
{
    bool vsync = viewer->stage.swapchain.vsync;
    for (uint32_t side = 0; side < VIEWER_SIDES; side++)
        viewer_close_side(viewer, side);
    display_finish(&viewer->stage.display);
    swapchain_finish(&viewer->stage.gpu, &viewer->stage.swapchain);
    gpu_screen_finish(&viewer->stage.gpu, &viewer->stage.screen);
    gpu_close(&viewer->stage.gpu);
    viewer->stage.swapchain.vsync = vsync;
    viewer->stage.has_kept = false;
}

bool viewer_recover(struct viewer *viewer, struct err *err)
{
    if (++viewer->stage.recoveries > RECOVERIES_MAX)
        return false;
    uint32_t messages = viewer->stage.gpu.validation_messages;
    char reason[sizeof err->msg];
    snprintf(reason, sizeof reason, "%s", err->msg);
    *err = (struct err){0};
    viewer_close_device(viewer);
    if (!viewer_open_device(viewer, err))
        return false;
    viewer->stage.gpu.validation_messages += messages;
    viewer_changed(viewer, CHANGE_METHOD);
    viewer_message(viewer, MESSAGE_WARNING, "%s: the device was opened again", reason);
    return true;
}
