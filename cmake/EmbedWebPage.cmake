# aligngs_embed_web_page(TARGET): compresses the files of web/dist and links them into TARGET; web_assets.h lists them.
function(aligngs_embed_web_page target)
  find_program(GZIP_PROGRAM gzip REQUIRED)
  file(GLOB files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/web/dist/*)
  set(folder ${CMAKE_BINARY_DIR}/web_page)
  file(MAKE_DIRECTORY ${folder})
  set(assembly ".section .rodata\n")
  set(declarations "")
  set(rows "")
  set(compressed "")
  foreach(file IN LISTS files)
    get_filename_component(name ${file} NAME)
    string(MAKE_C_IDENTIFIER aligngs_web_${name} id)
    set(gz ${folder}/${name}.gz)
    add_custom_command(OUTPUT ${gz} COMMAND ${GZIP_PROGRAM} -9nc ${file} > ${gz} DEPENDS ${file} VERBATIM)
    list(APPEND compressed ${gz})
    string(APPEND assembly ".global ${id}\n.global ${id}_end\n.balign 16\n${id}:\n.incbin \"${gz}\"\n${id}_end:\n.byte 0\n")
    string(APPEND declarations "extern const unsigned char ${id}[], ${id}_end[];\n")
    string(APPEND rows "    {\"/${name}\", ${id}, ${id}_end},\n")
  endforeach()
  string(APPEND assembly ".section .note.GNU-stack,\"\",@progbits\n")
  file(CONFIGURE OUTPUT ${folder}/web_assets.S CONTENT "${assembly}" @ONLY)
  file(CONFIGURE OUTPUT ${folder}/web_assets.h CONTENT
"#pragma once
struct WebAsset { const char* path; const unsigned char *begin, *end; };
extern \"C\" {
${declarations}}
inline const WebAsset kWebAssets[] = {
${rows}};
" @ONLY)
  set_source_files_properties(${folder}/web_assets.S PROPERTIES OBJECT_DEPENDS "${compressed}")
  add_custom_target(${target}_page DEPENDS ${compressed})
  target_sources(${target} PRIVATE ${folder}/web_assets.S)
  target_include_directories(${target} PRIVATE ${folder})
  add_dependencies(${target} ${target}_page)
endfunction()
