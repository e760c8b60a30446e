// plugins/NAME.so: empty but for its dependency on libanalytic_media_mitsuba.so, where Mitsuba
// finds init_plugin.
