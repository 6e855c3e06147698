print("package robot")
