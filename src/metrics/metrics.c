typedef int metrics_placeholder;
