/* The page's template as bytes of the program. LACUNA_REPORT_TEMPLATE is its path. */
  .section .rodata
  .global lacuna_report_template_begin
  .global lacuna_report_template_end
lacuna_report_template_begin:
  .incbin LACUNA_REPORT_TEMPLATE
lacuna_report_template_end:
  .byte 0
  .section .note.GNU-stack,"",%progbits
