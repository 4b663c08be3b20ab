typedef int bvh_trace_placeholder;
