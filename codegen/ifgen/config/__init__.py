"""What users ask for: options, [tool.ifgen], templates of their own, which warnings they want to see."""
