typedef int device_placeholder;
